// The kernel of every splat: of compact support, with the moments of a disc (the
// circle of confusion) convolved with a Gaussian (the unblurred splat).
//
// The unblurred resampling kernel is a Gaussian of variance V (Zwicker et al. 2001). The blur is a
// uniform disc of radius C, of variance (C^2/4) I. Let t = s / C^2, with s the unblurred variance
// along an axis. The convolution has the variance s + C^2/4 and the kurtosis of the radial kernel
// (1 - q)^n with n = 24 t (1 + 2 t)  (docs/formulas.md, section 3). A real n would need a power at
// each pixel. Up to n = 1, a plateau whose rim falls linearly in q has the same two moments, and
// nearly the convolution's own rim. From there, a mixture of the powers 1 and 2 has them. For
// n >= 2 the kernel stays at n = 2, a bell of 2.83 standard deviations.
//
// And the limits that every surfel renderer shares: where a kernel ends, when summed kernels make
// an opaque surface, and when light is too little to matter.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "render/scene/surfel_cloud.h"

namespace foci {

/// w(q) = min(k0, k1 t + k2 t^2) with t = 1 - q, for 0 <= q < 1, else 0; its integral over the unit
/// disc q = |x|^2 is 1. `k0` is its maximum. `support2` is the squared support radius over the
/// per-axis variance.
struct KernelShape {
  float k0, k1, k2;
  float support2;

  /// @param t  in (0, 1]
  float at(float t) const { return std::min(k0, t * (k1 + t * k2)); }
};

/// The largest exponent of the table.
inline constexpr float kMaxExponent = 2.0f;

/// Kernels with the kurtosis of (1 - q)^n, for n from 0 to kMaxExponent in equal steps of sqrt(n),
/// with which the rim grows.
inline constexpr int kKernelShapes = 257;
const std::array<KernelShape, kKernelShapes>& kernelShapes();

/// The kernel with the kurtosis of (1 - q)^n. n is clamped to 0 to 2; NaN falls to the bell.
/// @param shapes  `kernelShapes()`, at hand in a loop
inline const KernelShape& kernelShape(const KernelShape* shapes, float n) {
  constexpr float kSteps = kKernelShapes - 1;
  const float s =
      n < kMaxExponent ? std::sqrt(std::max(n, 0.0f) * (1.0f / kMaxExponent)) * kSteps : kSteps;
  return shapes[static_cast<int>(s + 0.5f)];
}
inline const KernelShape& kernelShape(float n) { return kernelShape(kernelShapes().data(), n); }

/// The exponent for an unblurred per-axis variance over the squared blur radius, t = s / C^2.
inline float kernelExponent(float t) { return 24.0f * t * (1.0f + 2.0f * t); }

/// Factor on the variance that merging added, so that the kernels of neighbouring nodes overlap. A
/// square node's spread is side^2 / 12, and its kernel needs (kSigmaPerSpacing side)^2.
inline constexpr float kOverlap = 12.0f * kSigmaPerSpacing * kSigmaPerSpacing;

/// Squared support radius of the widest kernel (n = 2), over its variance.
inline constexpr float kWidestSupport2 = 8.0f;

/// Squared standard deviations of an unblurred splat that its z-range spans, half of the paper's
/// x' V^-1 x / 2 < c with c = 2.5 (docs/formulas.md, section 5).
inline constexpr float kReach2 = 5.0f;

/// Splats of a larger variance or area are dropped: 10^5 by 10^5 pixels, beyond any image.
inline constexpr float kLargest_px2 = 1e10f;

/// Sum of kernel weights from which a surface is opaque. The kernels are a partition of unity; the
/// excess over one is their ripple. Splats that arrive later lie behind the surface.
inline constexpr float kOpaqueWeight = 1.01f;

/// Weight that a layer of a transparent scene gathers beyond kOpaqueWeight. Up to kNoise it is
/// sampling noise of the same surface; from kAnother on it is a second surface; in between it is
/// divided linearly. Chosen by hand; `Sweep.TransparentSheetsCompositeFrontToBack` bounds them.
inline constexpr float kNoise = 0.15f, kAnother = 0.4f;

/// Coverage of a layer as a function of its summed weight W. The kernels are a partition of unity
/// but for their ripple, so an opaque surface may sum to less than one. Up to `linear_to` the
/// coverage is W. From there it rises linearly, to 1 at `opaque_from`. Nothing behind an opaque
/// surface then shows, or is rendered.
struct CoverageRamp {
  float linear_to, opaque_from;
  constexpr float slope() const { return (1.0f - linear_to) / (opaque_from - linear_to); }
};

/// Unblurred kernels have more ripple than blurred ones, and a blurred edge is wide enough to show
/// a change of its coverage. Chosen by hand;
/// `KernelSums.AreOneOnARegularPlaneButForTheKernelsRipple` and
/// `Sweep.RendersNothingBehindAnOpaqueSheet` bound them.
inline constexpr CoverageRamp kSharpRamp{0.85f, 0.95f}, kBlurredRamp{0.98f, 0.995f};

/// Blur radius, in distances of samples, that leaves hardly any of the ripple. Chosen by hand: with
/// more, edges err more, with less, surfaces; `ClosedSurfaces.LeakNoBackgroundAtCrests` bounds it.
inline constexpr float kRippleSteps = 4.0f;

/// The ramp under the blur of the whole aperture.
inline CoverageRamp rampUnderBlur(float blur_steps) {
  const float linear = std::min(blur_steps / kRippleSteps, 1.0f), t = linear * linear;
  return {glm::mix(kSharpRamp.linear_to, kBlurredRamp.linear_to, t),
          glm::mix(kSharpRamp.opaque_from, kBlurredRamp.opaque_from, t)};
}

/// For an unblurred layer whose kernels lie all around the pixel (`pixelCoverageOf`): no edge lies
/// there, so what the kernels lack is a hole of their sum, as at crests. Gaps between leaves cover
/// less, or lie beside one edge. Chosen by hand; `ClosedSurfaces` tests bound it.
inline constexpr CoverageRamp kHoleRamp{0.6f, 0.75f};

/// Factor on a layer's weight under a low-pass of standard deviation s, so that the low-pass does
/// not show the background inside a surface; the outline grows instead. At the distance C from a
/// straight edge, where a lens of blur radius C sees the surface alone, the weight is Phi(C /
/// sqrt(s^2 + C^2/4)). Inside a right-angled corner it is the square of that. The factor is between
/// both, the inverse to the power of 1.5, so that limbs about as thick as the low-pass are opaque
/// too.
/// @return 1 for s = 0; 2.83 in focus
inline float closingFactor(float low_pass_px, float blur_px) {
  if (low_pass_px == 0.0f) return 1.0f;
  const float sigma_px = std::sqrt(low_pass_px * low_pass_px + 0.25f * blur_px * blur_px);
  const double edge = -blur_px / (1.41421356f * sigma_px);
  const auto inside = static_cast<float>(0.5 * std::erfc(edge));
  return 1.0f / (inside * std::sqrt(inside));
}

/// Coverage, 0 to 1, of a layer whose weights sum to `weight` >= 0.
inline float coverageOf(float weight, const CoverageRamp& ramp) {
  return std::min(1.0f,
                  std::max(weight, ramp.slope() * (weight - ramp.linear_to) + ramp.linear_to));
}

/// A sample whose transmittance is below this needs no further layers: half of the darkest linear
/// code step of an 8-bit sRGB image.
inline constexpr float kHidden = 1.0f / 8192.0f;

}  // namespace foci
