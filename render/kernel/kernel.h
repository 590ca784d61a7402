// The kernel that every splat is rendered with: a polynomial of compact support with the moments of
// (disc of the circle of confusion) * (Gaussian of the unblurred splat).
//
// The unblurred resampling kernel is a Gaussian of variance V (Zwicker et al. 2001), the blur a
// uniform disc of radius C with variance (C^2/4) I. Their convolution has, along an axis and with
// t = s / C^2 (s: unblurred variance), the variance s + C^2/4 and the kurtosis of the radial kernel
// (1 - q)^n with n = 24 t (1 + 2 t)  (formulas.md, section 3). A real n needs a power a pixel; a
// mixture of the two whole powers around n, on one support, reaches the same two moments with two
// multiply-adds and without truncation loss. For n >= 2 the kernel stays at n = 2, a bell of 2.83
// standard deviations.
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

/// The kernel whose kurtosis is that of (1 - q)^n. Tabulated; n < 0 is taken as 0 and n > 2 as 2.
const KernelShape& kernelShape(float n);

/// The exponent for an unblurred per-axis variance over the squared blur radius, t = s / C^2.
inline float kernelExponent(float t) { return 24.0f * t * (1.0f + 2.0f * t); }

/// The largest exponent of the table.
inline constexpr float kMaxExponent = 2.0f;

}  // namespace foci
