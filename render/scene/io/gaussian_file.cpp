#include "render/scene/io/gaussian_file.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>

#include "base/input_error.h"
#include "base/quantile.h"
#include "base/text.h"
#include "render/scene/io/scan_values.h"
#include "render/scene/point_cloud.h"

namespace foci {
namespace {

/// Standard deviations outside of these are no part of a scene, and their squares must stay finite.
constexpr float kMinSigma = 1e-9f, kMaxSigma = 1e6f;

bool isFinite(const glm::vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// Trained Gaussians are about as large as the distance to their neighbours. Chosen by hand.
constexpr float kFarTooLarge = 8.0f;

/// The median of a Gaussian's size over the distance of neighbours, as if all lay on the faces of
/// the box of the middle 98 %. 0 for few Gaussians.
float sizeInSpacings(const GaussianCloud& cloud) {
  constexpr std::size_t kFew = 64, kMost = 20'000;
  if (cloud.size() < kFew) return 0.0f;
  const std::size_t step = cloud.size() / kMost + 1;
  glm::vec3 side(0.0f);
  std::vector<float> values;
  for (int axis = 0; axis < 3; ++axis) {
    values.clear();
    for (std::size_t i = 0; i < cloud.size(); i += step)
      values.push_back(cloud.position_m[i][axis]);
    side[axis] = quantile(values, 0.99) - quantile(values, 0.01);
  }
  const float area = 2.0f * (side.x * side.y + side.y * side.z + side.z * side.x);
  if (!(area > 0.0f)) return 0.0f;
  values.clear();
  for (std::size_t i = 0; i < cloud.size(); i += step) {
    values.push_back(std::sqrt(traceOf(cloud.covariance_m2[i]) / 3.0f));
  }
  return quantile(values, 0.5) / std::sqrt(area / static_cast<float>(cloud.size()));
}

}  // namespace

GaussianCollector::GaussianCollector(GaussianFile& file, std::size_t count, int degree)
    : file_(file) {
  assert(degree >= 0 && degree <= kMaxHarmonicsDegree);
  GaussianCloud& cloud = file.cloud;
  cloud.degree = degree;
  cloud.position_m.reserve(count);
  cloud.covariance_m2.reserve(count);
  cloud.opacity.reserve(count);
  cloud.color.reserve(count);
  cloud.harmonics.reserve(count * cloud.harmonicsPerGaussian());
}

void GaussianCollector::append(const RawGaussian& raw, std::span<const float> harmonics) {
  GaussianCloud& cloud = file_.cloud;
  assert(harmonics.size() == cloud.harmonicsPerGaussian());
  const bool sound =
      isNearEnough(raw.position) && isFinite(raw.sigma) && std::isfinite(raw.opacity) &&
      isFinite(raw.color) &&
      std::ranges::all_of(harmonics, [](float value) { return std::isfinite(value); });
  if (!sound) {
    ++file_.dropped;
    return;
  }
  const float length2 = glm::dot(raw.rotation, raw.rotation);
  const bool rotated = length2 > 1e-12f && std::isfinite(length2);
  const glm::vec4 rotation =
      rotated ? raw.rotation / std::sqrt(length2) : glm::vec4(0.0f, 0.0f, 0.0f, 1.0f);
  cloud.position_m.push_back(raw.position);
  cloud.covariance_m2.push_back(
      covarianceOf(glm::clamp(raw.sigma, kMinSigma, kMaxSigma), rotation));
  cloud.opacity.push_back(std::clamp(raw.opacity, 0.0f, 1.0f));
  // Far beyond what a display shows, and small enough for sums to stay finite.
  constexpr float kMaxColor = 1000.0f;
  cloud.color.push_back(glm::clamp(raw.color, -kMaxColor, kMaxColor));
  constexpr float kMaxStep = std::numeric_limits<std::int16_t>::max();
  for (const float value : harmonics) {
    const float steps = std::clamp(value / kHarmonicsStep, -kMaxStep, kMaxStep);
    cloud.harmonics.push_back(static_cast<std::int16_t>(std::lrint(steps)));
  }
}

void finishGaussians(GaussianFile& file, const std::string& path, const KnownGaussians& known) {
  if (!file.cloud.empty()) {
    if (!known.fine && file.cloud.size() > 1 && losesDetail(file.cloud.position_m)) {
      file.remarks.emplace_back(
          "the Gaussians are so far from the origin that floats lose their detail: save them "
          "nearer to the origin, or as a PLY with coordinates in doubles");
    }
    if (std::ranges::all_of(file.cloud.opacity,
                            [](float opacity) { return opacity <= kMinAlpha; })) {
      file.remarks.emplace_back(
          "the opacity of all Gaussians is below 1/255, so none is seen: in a PLY, opacity is a "
          "logit");
    }
    const float size = known.knows_scales ? 0.0f : sizeInSpacings(file.cloud);
    if (size > kFarTooLarge) {
      file.remarks.push_back("the Gaussians are " + significant(double{size}, 2) +
                             " times as large as the distance to their neighbours: are their "
                             "scales stored as the format expects?");
    }
    return;
  }
  if (file.dropped == 0) throw InputError(path, "has no Gaussians");
  throw InputError(path, file.dropped == 1 ? "its only Gaussian has a value that is not finite"
                                           : "none of its " + std::to_string(file.dropped) +
                                                 " Gaussians has finite values");
}

int degreeOf(int values) {
  int degree = 0;
  while (degree < 5 && 3 * harmonicsOf(degree) != values) ++degree;
  return degree;
}

std::array<float, 4> quaternionOf(const std::array<float, 3>& three, std::size_t left_out) {
  std::array<float, 4> all{};
  float sum = 0.0f;
  for (std::size_t k = 0, at = 0; k < 4; ++k) {
    if (k == left_out) continue;
    all[k] = three[at++];
    sum += all[k] * all[k];
  }
  all[left_out] = std::sqrt(std::max(1.0f - sum, 0.0f));
  return all;
}

float sigmoid(float x) { return 1.0f / (1.0f + std::exp(-x)); }

}  // namespace foci
