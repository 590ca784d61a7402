// The overlap integral of two kernels, tabulated. Private to the scene.
#pragma once

#include <array>

namespace foci {

/// The overlap integral of two unblurred kernels (1 - q)^2 (kernel.h, n = 2) in a plane. With their
/// variances v1 <= v2 and their distance d,
///   int K_v1(x) K_v2(x - d) dx = F(d^2 / (16 (v1 + v2)), sqrt(v1 / v2)) / (v1 + v2).
/// Kernels of equal size touch at d^2 = 16 (v1 + v2).
class KernelOverlap {
 public:
  static const KernelOverlap& table();

  /// F by rows of equal ratio, from kMinRatio to 1, and columns of equal q, from 0 to 1. Between
  /// them it is linear within 1e-4 of the largest value. A smaller ratio counts as kMinRatio; from
  /// q = 1 on, F is 0.
  const float* values() const { return overlap_[0].data(); }
  static constexpr int kSteps = 256, kColumns = kSteps + 2, kRatios = 12;
  static constexpr float kMinRatio = 0.4f;  // sizes of neighbours seldom differ more
  static constexpr float kRatiosPerUnit = kRatios / (1.0f - kMinRatio);

  /// For equal kernels, the share of the integral of F that lies beyond q >= 0.
  float beyond(float q) const;

 private:
  KernelOverlap();
  std::array<std::array<float, kColumns>, kRatios + 1> overlap_;
  std::array<float, kColumns> beyond_;
};

}  // namespace foci
