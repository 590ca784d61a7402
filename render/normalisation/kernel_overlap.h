// The overlap integral of two kernels, tabulated. Private to the scene.
#pragma once

#include <array>
#include <cstddef>

namespace foci {

/// The overlap integral of two unblurred kernels (1 - q)^2 (kernel.h, n = 2) in a plane. With their
/// variances v1 and v2 and their distance d,
///   int K_v1(x) K_v2(x - d) dx = `of`(d^2 / (16 (v1 + v2)), sqrt(v1 / v2)) / (v1 + v2).
/// Kernels of equal size touch at d^2 = 16 (v1 + v2).
class KernelOverlap {
 public:
  static const KernelOverlap& table();

  /// Exact within 1e-4 of the largest value.
  /// @param q      >= 0
  /// @param ratio  0 to 1; a ratio below 0.4 counts as 0.4
  float of(float q, float ratio) const;

  /// For equal kernels, the share of the integral of `of` that lies beyond q.
  float beyond(float q) const;

 private:
  static constexpr std::size_t kSteps = 256, kRatios = 12;
  KernelOverlap();
  std::array<std::array<float, kSteps + 2>, kRatios + 1> overlap_;
  std::array<float, kSteps + 2> beyond_;
};

}  // namespace foci
