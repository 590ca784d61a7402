#include "render/normalisation/kernel_overlap.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace foci {
namespace {

constexpr double kMinRatio = 0.4;  // sizes of neighbours seldom differ more
constexpr int kRings = 64, kAngles = 64;

/// The overlap of kernels of radii `radius` and 1, by the midpoint rule over the smaller disc, in
/// rings of equal area.
double overlap(double radius, double distance) {
  static const auto cosines = [] {
    std::array<double, kAngles> all{};
    for (int k = 0; k < kAngles; ++k) all[k] = std::cos(std::numbers::pi * (k + 0.5) / kAngles);
    return all;
  }();
  double sum = 0.0;
  for (int ring = 0; ring < kRings; ++ring) {
    const double q = (ring + 0.5) / kRings, r = radius * std::sqrt(q);
    const double middle = 1.0 - r * r - distance * distance;
    double of_ring = 0.0;
    for (const double cosine : cosines) {
      const double left = std::max(middle + 2.0 * r * distance * cosine, 0.0);
      of_ring += left * left;
    }
    sum += (1.0 - q) * (1.0 - q) * of_ring;
  }
  return 9.0 / std::numbers::pi * sum / (kRings * kAngles);
}

}  // namespace

const KernelOverlap& KernelOverlap::table() {
  static const KernelOverlap overlap;
  return overlap;
}

KernelOverlap::KernelOverlap() {
  for (std::size_t r = 0; r <= kRatios; ++r) {
    const double radius = kMinRatio + (1.0 - kMinRatio) * static_cast<double>(r) / kRatios;
    const double variance = (radius * radius + 1.0) / 8.0;
    for (std::size_t k = 0; k < kSteps + 2; ++k) {
      const double distance2 = 16.0 * variance * static_cast<double>(k) / kSteps;
      overlap_[r][k] = static_cast<float>(variance * overlap(radius, std::sqrt(distance2)));
    }
  }
  double sum = 0.0;
  beyond_[kSteps + 1] = beyond_[kSteps] = 0.0f;
  for (std::size_t k = kSteps; k-- > 0;) {
    sum += 0.5 * (overlap_[kRatios][k] + overlap_[kRatios][k + 1]);
    beyond_[k] = static_cast<float>(16.0 * std::numbers::pi / kSteps * sum);
  }
}

float KernelOverlap::of(float q, float ratio) const {
  if (!(q < 1.0f)) return 0.0f;
  const float at = q * static_cast<float>(kSteps);
  const auto k = static_cast<std::size_t>(at);
  const float t = at - static_cast<float>(k);
  const float row = std::max(ratio - static_cast<float>(kMinRatio), 0.0f) *
                    static_cast<float>(kRatios / (1.0 - kMinRatio));
  const std::size_t r = std::min(static_cast<std::size_t>(row), kRatios - 1);
  const float s = row - static_cast<float>(r);
  const float low = overlap_[r][k] + s * (overlap_[r + 1][k] - overlap_[r][k]);
  const float high = overlap_[r][k + 1] + s * (overlap_[r + 1][k + 1] - overlap_[r][k + 1]);
  return low + t * (high - low);
}

float KernelOverlap::beyond(float q) const {
  if (!(q < 1.0f)) return 0.0f;
  const float at = q * static_cast<float>(kSteps);
  const auto k = static_cast<std::size_t>(at);
  return beyond_[k] + (at - static_cast<float>(k)) * (beyond_[k + 1] - beyond_[k]);
}

}  // namespace foci
