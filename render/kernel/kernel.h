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

#include <array>
#include <glm/glm.hpp>

namespace foci {

/// w(q) = k0 + k1 t + k2 t^2 with t = 1 - q, for 0 <= q < 1, else 0; its integral over the unit
/// disc q = |x|^2 is 1. `support2` is the squared support radius over the per-axis variance.
struct KernelShape {
  float k0, k1, k2;
  float support2;
};

/// The kernel with the kurtosis of (1 - q)^n. Tabulated; n is clamped to 0 to 2.
const KernelShape& kernelShape(float n);

/// The exponent for an unblurred per-axis variance over the squared blur radius, t = s / C^2.
inline float kernelExponent(float t) { return 24.0f * t * (1.0f + 2.0f * t); }

/// The largest exponent of the table.
inline constexpr float kMaxExponent = 2.0f;

}  // namespace foci
