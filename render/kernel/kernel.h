// The kernel of every splat: a polynomial of compact support that has the moments of a disc (the
// circle of confusion) convolved with a Gaussian (the unblurred splat).
//
// The unblurred resampling kernel is a Gaussian of variance V (Zwicker et al. 2001). The blur is a
// uniform disc of radius C, of variance (C^2/4) I. Let t = s / C^2, with s the unblurred variance
// along an axis. The convolution has the variance s + C^2/4 and the kurtosis of the radial kernel
// (1 - q)^n with n = 24 t (1 + 2 t)  (docs/formulas.md, section 3). A real n would need a power at
// each pixel. A mixture of the two integer powers around n, on one support, has the same two
// moments. It takes two multiply-adds and loses nothing by truncation. For n >= 2 the kernel stays
// at n = 2, a bell of 2.83 standard deviations.
#pragma once

#include <algorithm>
#include <array>
#include <glm/glm.hpp>

namespace foci {

/// w(q) = k0 + k1 t + k2 t^2 with t = 1 - q, for 0 <= q < 1, else 0; its integral over the unit
/// disc q = |x|^2 is 1. `support2` is the squared support radius over the per-axis variance.
struct KernelShape {
  float k0, k1, k2;
  float support2;
};

/// The largest exponent of the table.
inline constexpr float kMaxExponent = 2.0f;

/// Kernels with the kurtosis of (1 - q)^n, for n from 0 to kMaxExponent in equal steps.
inline constexpr int kKernelShapes = 257;
const std::array<KernelShape, kKernelShapes>& kernelShapes();

/// The kernel with the kurtosis of (1 - q)^n. n is clamped to 0 to 2; NaN falls to the bell.
/// @param shapes  `kernelShapes()`, at hand in a loop
inline const KernelShape& kernelShape(const KernelShape* shapes, float n) {
  constexpr float kSteps = kKernelShapes - 1;
  const float s = n < kMaxExponent ? std::max(n, 0.0f) * (kSteps / kMaxExponent) : kSteps;
  return shapes[static_cast<int>(s + 0.5f)];
}
inline const KernelShape& kernelShape(float n) { return kernelShape(kernelShapes().data(), n); }

/// The exponent for an unblurred per-axis variance over the squared blur radius, t = s / C^2.
inline float kernelExponent(float t) { return 24.0f * t * (1.0f + 2.0f * t); }

}  // namespace foci
