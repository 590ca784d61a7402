// Without OpenCV: its first conversion to L*a*b* in a process takes longer than a frame, since it
// fills a table in software floating point and looks for OpenCL. `auto` compares squares in its
// first frame.
#include "render/image/visible_difference.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "base/parallel.h"

namespace foci {
namespace {

constexpr double kEye_deg = 0.5 / 60.0;  // standard deviation of the blur of an eye in focus

/// The Gaussian is cut off at this many standard deviations, where it is 0.0003 of its peak.
constexpr double kReach = 4.0;

/// Half of a Gaussian's samples from the middle on. All samples sum to one.
std::vector<float> gaussianFromMiddle(double sigma_px) {
  const auto reach_px = static_cast<std::size_t>(std::ceil(kReach * sigma_px));
  std::vector<double> half(reach_px + 1);
  double sum = 0.0;
  for (std::size_t i = 0; i <= reach_px; ++i) {
    const double x = static_cast<double>(i) / sigma_px;
    half[i] = std::exp(-0.5 * x * x);
    sum += i == 0 ? half[i] : 2.0 * half[i];
  }
  std::vector<float> weights;
  weights.reserve(half.size());
  for (const double each : half) weights.push_back(static_cast<float>(each / sum));
  return weights;
}

/// Sum of the samples `at(i - k)` and `at(i + k)` times weights[k]. Beyond the ends the first and
/// the last sample continue.
template <typename At>
glm::vec3 filtered(const std::vector<float>& weights, int i, int count, const At& at) {
  glm::vec3 sum = weights[0] * at(i);
  for (int k = 1; k < static_cast<int>(weights.size()); ++k) {
    sum += weights[static_cast<std::size_t>(k)] *
           (at(std::max(i - k, 0)) + at(std::min(i + k, count - 1)));
  }
  return sum;
}

/// CIE 1976 L*a*b* of linear RGB.
glm::vec3 labOf(const glm::vec3& rgb) {
  const auto curve = [](float t) {
    return t > kLinearBelow ? static_cast<float>(std::cbrt(double{t}))
                            : kLinearSlope * t + 16.0f / 116.0f;
  };
  const glm::vec3 xyz = kXyzOfWhite * rgb;
  return kLabOfCurve * glm::vec3(curve(xyz.x), curve(xyz.y), curve(xyz.z)) -
         glm::vec3(16.0f, 0.0f, 0.0f);
}

/// The frame's L*a*b* behind the blur of the eye, row by row.
std::vector<glm::vec3> seenBy(const std::vector<float>& eye, const Frame& frame) {
  const int width = frame.size_px.x, height = frame.size_px.y;
  const auto forEachPixel = [&](const auto& visit) {
    parallelFor(static_cast<std::size_t>(height), [&](std::size_t y) {
      const std::size_t row = y * static_cast<std::size_t>(width);
      for (int x = 0; x < width; ++x) {
        visit(x, static_cast<int>(y), row + static_cast<std::size_t>(x));
      }
    });
  };
  const auto at = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  };
  std::vector<glm::vec3> along(frame.rgba.size()), lab(frame.rgba.size());
  forEachPixel([&](int x, int y, std::size_t pixel) {
    along[pixel] = filtered(eye, x, width, [&](int i) {
      return glm::clamp(glm::vec3(frame.rgba[at(i, y)]), 0.0f, 1.0f);
    });
  });
  forEachPixel([&](int x, int y, std::size_t pixel) {
    lab[pixel] = labOf(filtered(eye, y, height, [&](int i) { return along[at(x, i)]; }));
  });
  return lab;
}

}  // namespace

std::vector<float> visibleDifference(const Frame& a, const Frame& b, double px_per_deg) {
  assert(a.size_px == b.size_px);
  return visibleDifference(a, labOf(b, px_per_deg), px_per_deg);
}

std::vector<glm::vec3> labOf(const Frame& frame, double px_per_deg) {
  assert(px_per_deg > 0.0);
  return seenBy(gaussianFromMiddle(kEye_deg * px_per_deg), frame);
}

std::vector<float> visibleDifference(const Frame& a, const std::vector<glm::vec3>& lab_b,
                                     double px_per_deg) {
  assert(a.rgba.size() == lab_b.size());
  const std::vector<glm::vec3> lab_a = labOf(a, px_per_deg);
  std::vector<float> difference(a.rgba.size());
  for (std::size_t i = 0; i < difference.size(); ++i) {
    difference[i] = glm::distance(lab_a[i], lab_b[i]) / kJustNoticeable;
  }
  return difference;
}

glm::mat3 visibleDifferencePerLight(const glm::vec3& rgb) {
  const auto slope = [](float t) {
    const auto root = static_cast<float>(std::cbrt(double{t}));
    return t > kLinearBelow ? 1.0f / (3.0f * root * root) : kLinearSlope;
  };
  const glm::vec3 xyz = kXyzOfWhite * glm::clamp(rgb, 0.0f, 1.0f);
  glm::mat3 per_light = kXyzOfWhite;
  for (int i = 0; i < 3; ++i) {
    per_light[i] *= glm::vec3(slope(xyz.x), slope(xyz.y), slope(xyz.z)) / kJustNoticeable;
  }
  return kLabOfCurve * per_light;
}

}  // namespace foci
