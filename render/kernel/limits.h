// Where a splat, a layer and the light end: bounds on which all that render surfels agree.
#pragma once

#include <algorithm>

#include "render/scene/surfel_cloud.h"

namespace foci {

/// Of the variance that merging added, what a kernel needs for neighbours to overlap: a square's
/// spread is side^2 / 12, its kernel wants (kSigmaPerSpacing side)^2.
inline constexpr float kOverlap = 12.0f * kSigmaPerSpacing * kSigmaPerSpacing;

/// A kernel's footprint reaches at most this many squared standard deviations (n = 2).
inline constexpr float kWidestSupport2 = 8.0f;

/// The unblurred splat's z-range: its plane within this many squared standard deviations.
inline constexpr float kReach2 = 5.0f;

/// Cosine from which a surfel counts as seen from behind: beyond what normals of a scan err by at
/// its outline.
inline constexpr float kBackFacing = 0.1f;

/// Splats beyond any use are refused: a variance or an area of 10^5 by 10^5 pixels.
inline constexpr float kLargest_px2 = 1e10f;

/// A surface's kernels sum to one, a little noise aside: what comes once they have reached this
/// lies behind it.
inline constexpr float kWhole = 1.01f;

/// In transparent scenes, where that is seen: it is noise of the samples up to `kNoise`, another
/// surface from `kAnother` on, and in between in part either.
inline constexpr float kNoise = 0.15f, kAnother = 0.4f;

/// They sum to one but for their ripple. What they cover from `whole` on counts as all, so that
/// nothing is seen, nor rendered, behind a closed surface; up to `part` it counts as it is; in
/// between it rises evenly from the one to the other. Blur evens the ripple out, and a blurred edge
/// is wide.
struct Ripple {
  float part, whole;
  constexpr float slope() const { return (1.0f - part) / (whole - part); }
};
inline constexpr Ripple kSharpRipple{0.9f, 0.98f}, kBlurredRipple{0.98f, 0.995f};

/// What a layer covers whose weights sum to `weight`.
inline float coverageOf(float weight, const Ripple& ripple) {
  return std::min(1.0f, std::max(weight, ripple.slope() * (weight - ripple.part) + ripple.part));
}

/// Light that passes below this is not worth another layer: half a step of an 8-bit image's
/// darkest, linear, code.
inline constexpr float kHidden = 1.0f / 8192.0f;

}  // namespace foci
