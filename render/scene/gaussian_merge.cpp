#include "render/scene/gaussian_merge.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

namespace foci {
namespace {

/// Variance of a pixel's low-pass, 0.3 px^2, over a node's spread where that is 1 px^2.
constexpr double kLowPassPerSpread = 0.3;

/// A direction, as two axes across it.
struct Across {
  glm::vec3 u, v;
  float weight;
};

const std::array<Across, 7>& directions() {
  static const auto all = [] {
    constexpr float kAxis = 2.0f / 15.0f, kDiagonal = 3.0f / 20.0f;
    std::array<Across, 7> list{};
    const std::array<glm::vec3, 7> along{
        glm::vec3(1, 0, 0),  glm::vec3(0, 1, 0),  glm::vec3(0, 0, 1), glm::vec3(1, 1, 1),
        glm::vec3(1, 1, -1), glm::vec3(1, -1, 1), glm::vec3(-1, 1, 1)};
    for (std::size_t k = 0; k < list.size(); ++k) {
      const glm::vec3 d = glm::normalize(along[k]);
      const glm::vec3 helper = k == 0 ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
      const glm::vec3 u = glm::normalize(glm::cross(d, helper));
      list[k] = {u, glm::cross(d, u), k < 3 ? kAxis : kDiagonal};
    }
    return list;
  }();
  return all;
}

/// A symmetric 2x2 matrix.
struct Covariance2 {
  float xx, xy, yy;
  float determinant() const { return std::max(xx * yy - xy * xy, 0.0f); }
};

Covariance2 across(const Covariance3& covariance, const Across& d) {
  const glm::mat3 s = matrixOf(covariance);
  const glm::vec3 su = s * d.u;
  return {glm::dot(d.u, su), glm::dot(d.v, su), glm::dot(d.v, s * d.v)};
}

/// Area that two Gaussians cover together.
double coveredBy(const GaussianMoments& a, const GaussianMoments& b) {
  constexpr float kTwoPi = 2.0f * std::numbers::pi_v<float>;
  const auto alpha_a = static_cast<float>(std::min(a.opacity, 1.0));
  const auto alpha_b = static_cast<float>(std::min(b.opacity, 1.0));
  const auto wide_a = static_cast<float>(std::max(a.opacity, 1.0));
  const auto wide_b = static_cast<float>(std::max(b.opacity, 1.0));
  // Of two equal flat tops: opacity - 1/2, in place of opacity / 2.
  const float flat = 2.0f - 1.0f / std::sqrt(wide_a * wide_b);
  const glm::vec3 apart(b.mean_m - a.mean_m);
  double sum = 0.0;
  for (const Across& d : directions()) {
    const auto widened = [](Covariance2 v, float by) {
      return Covariance2{v.xx * by, v.xy * by, v.yy * by};
    };
    const Covariance2 va = widened(across(a.covariance_m2, d), wide_a);
    const Covariance2 vb = widened(across(b.covariance_m2, d), wide_b);
    const float det_a = va.determinant(), det_b = vb.determinant();
    const float covered_a = alpha_a * kTwoPi * std::sqrt(det_a);
    const float covered_b = alpha_b * kTwoPi * std::sqrt(det_b);
    const Covariance2 s{va.xx + vb.xx, va.xy + vb.xy, va.yy + vb.yy};
    const float det = s.determinant();
    float overlap = 0.0f;
    if (det > 0.0f) {
      const float x = glm::dot(apart, d.u), y = glm::dot(apart, d.v);
      const float q = (s.yy * x * x - 2.0f * s.xy * x * y + s.xx * y * y) / det;
      overlap = flat * alpha_a * alpha_b * kTwoPi * std::sqrt(det_a / det) * std::sqrt(det_b) *
                std::exp(-0.5f * q);
      overlap = std::min({overlap, covered_a, covered_b});
    }
    sum += double{d.weight} * double{covered_a + covered_b - overlap};
  }
  return sum;
}

// sRGB (IEC 61966-2-1), continued beyond 0 and 1: harmonics may lead there.
float linearOfDisplay(float s) {
  return s <= 0.04045f ? s / 12.92f : std::pow((s + 0.055f) / 1.055f, 2.4f);
}
/// Change of the linear light by the display value.
float slopeAt(float s) {
  return s <= 0.04045f ? 1.0f / 12.92f : 2.4f / 1.055f * std::pow((s + 0.055f) / 1.055f, 1.4f);
}
glm::vec3 slopesAt(const glm::vec3& s) { return {slopeAt(s.r), slopeAt(s.g), slopeAt(s.b)}; }

/// @param weight  of `a`; that of `b` is the rest
MeanColor mean(const MeanColor& a, const MeanColor& b, double weight) {
  const auto of_a = static_cast<float>(weight);
  MeanColor sum{.color = glm::mix(b.color, a.color, of_a)};
  for (std::size_t k = 0; k < sum.harmonics.size(); ++k) {
    sum.harmonics[k] = glm::mix(b.harmonics[k], a.harmonics[k], of_a);
  }
  return sum;
}

}  // namespace

float displayOfLinear(float light) {
  return light <= 0.0031308f ? 12.92f * light : 1.055f * std::pow(light, 1.0f / 2.4f) - 0.055f;
}

double meanArea_m2(const Covariance3& covariance_m2) {
  double sum = 0.0;
  for (const Across& d : directions()) {
    sum += double{d.weight} * std::sqrt(double{across(covariance_m2, d).determinant()});
  }
  return 2.0 * std::numbers::pi * sum;
}

float peakOf(float opacity) { return opacity <= 1.0f ? opacity : std::exp(opacity - 1.0f); }

float opacityAfterLowPass(float opacity, float growth, float shrinkage) {
  const double light = growth * shrinkage * std::expm1(double{opacity - kMinAlpha});
  return kMinAlpha + static_cast<float>(std::log1p(light));
}

GaussianMoments momentsOf(const GaussianCloud& cloud, std::size_t i) {
  GaussianMoments of;
  of.mean_m = glm::dvec3(cloud.position_m[i]);
  of.covariance_m2 = cloud.covariance_m2[i];
  of.opacity = std::max(cloud.opacity[i] - kMinAlpha, 0.0f);
  // Positive, so that means exist where nothing is visible.
  constexpr double kFaintest = 1e-6;
  of.covered_m2 = std::max(std::max(of.opacity, kFaintest) * meanArea_m2(of.covariance_m2),
                           std::numeric_limits<double>::min());
  of.alone_m2 = of.covered_m2;
  of.opaque_m2 = of.covered_m2 * of.opacity;
  of.growth = 2.0 * std::numbers::pi * of.opacity;
  of.radius_m = 3.0 * std::sqrt(std::max(double{traceOf(of.covariance_m2)}, 0.0));
  const glm::vec3& color = cloud.color[i];
  of.blended.color = color;
  of.side_by_side.color = {linearOfDisplay(color.r), linearOfDisplay(color.g),
                           linearOfDisplay(color.b)};
  const std::size_t count = cloud.harmonicsPerGaussian();
  if (count == 0) return of;
  const glm::vec3 slope = slopesAt(color);
  for (std::size_t k = 0; k < count; ++k) {
    of.blended.harmonics[k] = kHarmonicsStep * cloud.harmonics[i * count + k];
    of.side_by_side.harmonics[k] = slope[static_cast<int>(k % 3)] * of.blended.harmonics[k];
  }
  return of;
}

GaussianMoments merged(const GaussianMoments& a, const GaussianMoments& b) {
  GaussianMoments sum;
  const double fa = a.covered_m2 / (a.covered_m2 + b.covered_m2), fb = 1.0 - fa;
  sum.mean_m = fa * a.mean_m + fb * b.mean_m;
  const glm::dvec3 d = b.mean_m - a.mean_m;
  const auto moment = [&](float of_a, float of_b, double between) {
    return static_cast<float>(fa * of_a + fb * of_b + fa * fb * between);
  };
  const Covariance3 &va = a.covariance_m2, &vb = b.covariance_m2;
  Covariance3& v = sum.covariance_m2;
  v = {moment(va.xx, vb.xx, d.x * d.x), moment(va.xy, vb.xy, d.x * d.y),
       moment(va.xz, vb.xz, d.x * d.z), moment(va.yy, vb.yy, d.y * d.y),
       moment(va.yz, vb.yz, d.y * d.z), moment(va.zz, vb.zz, d.z * d.z)};
  sum.covered_m2 = std::max(coveredBy(a, b), std::numeric_limits<double>::min());
  const double area_m2 = meanArea_m2(v);
  sum.opacity = area_m2 > 0.0 ? sum.covered_m2 / area_m2 : fa * a.opacity + fb * b.opacity;

  sum.alone_m2 = a.alone_m2 + b.alone_m2;
  sum.opaque_m2 = a.opaque_m2 + b.opaque_m2;
  sum.growth = a.growth + b.growth;
  sum.side_by_side = mean(a.side_by_side, b.side_by_side, fa);
  sum.blended = mean(a.blended, b.blended, sum.growth > 0.0 ? a.growth / sum.growth : fa);

  const auto changeOf = [&](const GaussianMoments& one) {
    const glm::dvec3 moved = one.mean_m - sum.mean_m;
    const double widened = std::abs(double{traceOf(v)} - double{traceOf(one.covariance_m2)});
    return one.spread_m2 + 0.5 * std::max(glm::dot(moved, moved), widened);
  };
  sum.spread_m2 = fa * changeOf(a) + fb * changeOf(b);
  sum.radius_m = std::max(glm::length(a.mean_m - sum.mean_m) + a.radius_m,
                          glm::length(b.mean_m - sum.mean_m) + b.radius_m);
  return sum;
}

void store(const GaussianMoments& moments, GaussianCloud& cloud, std::size_t i) {
  cloud.position_m[i] = glm::vec3(moments.mean_m);
  cloud.covariance_m2[i] = moments.covariance_m2;
  cloud.opacity[i] = static_cast<float>(moments.opacity) + kMinAlpha;
  const double with_low_pass_m2 =
      moments.alone_m2 + kLowPassPerSpread * moments.spread_m2 * moments.growth;
  const auto apart = static_cast<float>(moments.opaque_m2 / moments.alone_m2 *
                                        std::min(moments.covered_m2 / with_low_pass_m2, 1.0));
  const glm::vec3& l = moments.side_by_side.color;
  const glm::vec3 color(displayOfLinear(l.r), displayOfLinear(l.g), displayOfLinear(l.b));
  cloud.color[i] = glm::mix(moments.blended.color, color, apart);
  const std::size_t count = cloud.harmonicsPerGaussian();
  if (count == 0) return;
  const glm::vec3 slope = slopesAt(color);
  for (std::size_t k = 0; k < count; ++k) {
    const float value =
        glm::mix(moments.blended.harmonics[k],
                 moments.side_by_side.harmonics[k] / slope[static_cast<int>(k % 3)], apart);
    cloud.harmonics[i * count + k] = static_cast<std::int16_t>(
        std::clamp(std::round(value / kHarmonicsStep), -32767.0f, 32767.0f));
  }
}

}  // namespace foci
