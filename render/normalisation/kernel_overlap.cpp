#include "render/normalisation/kernel_overlap.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace foci {
namespace {

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
  for (std::size_t r = 0; r < overlap_.size(); ++r) {
    const double radius = std::min(kMinRatio + static_cast<double>(r) / kRatiosPerUnit, 1.0);
    const double variance = (radius * radius + 1.0) / 8.0;
    for (std::size_t k = 0; k < kColumns; ++k) {
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

float KernelOverlap::beyond(float q) const {
  if (!(q < 1.0f)) return 0.0f;
  const float at = q * static_cast<float>(kSteps);
  const auto k = static_cast<std::size_t>(at);
  return beyond_[k] + (at - static_cast<float>(k)) * (beyond_[k + 1] - beyond_[k]);
}

}  // namespace foci
