// The constants of the splat renderer. The SIMD code includes them; `shaderText`
// (render/gl/shader_text.h) states them for the compute shaders.
#pragma once

namespace foci {

// Projection.

/// Weight of the longer axis of an ellipse of confusion in the kernel's shape (`blurEllipse`), 0
/// to 1. At 0 the light of a line is cut off beyond the lens's rim, 4 % of its variance. At 1
/// kernels a pixel wide become discs there and sum to one within 2.5 % only, against 0.3 % at this
/// value.
inline constexpr float kLongAxis = 0.6f;

/// Round parts of a lens overlap, and would spread coma too far: its slope within a part of radius
/// a counts by sqrt(1 - kComaOverlap a^2). 7 and 19 parts then have the lens's variance of coma
/// within 3 % along each axis, and 1 % in all.
inline constexpr float kComaOverlap = 1.17f;

/// Every tilt (`SplatLens`) is reduced by this, and smaller ones become 0. Chosen by hand: an eye's
/// pupil seldom causes a larger tilt.
inline constexpr float kMinTilt = 0.01f;

/// In a node's slant, where rounded products cancel: a lower bound of its squared cosine, and for
/// the nodes of a wire the rounding error of adj(V), over the square of V's trace.
inline constexpr float kLeastCos2 = 1e-4f, kRounding = 1e-7f;

/// Peak light of one splat, of a white surface's, from which it counts as a highlight; from twice
/// that peak fully. Chosen by hand.
inline constexpr float kHighlight = 0.06f;

/// The peak of a light counts by as much more as the light exceeds white, up to this. In coarse
/// samples a lone disc errs by up to a sixth, and on black that shows (2.3 in L*, the luminance
/// 0.0025) from a peak of kHighlight / kLight on.
inline constexpr float kLight = 3.5f;

/// A highlight's samples are closer by this share; samples of splats that acuity softens are this
/// factor farther apart. Chosen by hand: the errors are finer than the observer resolves.
inline constexpr float kFiner = 0.6f, kCoarser = 1.4f;

/// Kernels sum to one within a few per cent. Behind an open surface lies what the dips show. Behind
/// the front of a closed body lies its back, which is not rendered, so the front alone must cover.
/// Its kernels count by this much more where the lens's blur does not even them out.
inline constexpr float kFrontCover = 0.05f;

// Tiles.

/// Smallest standard deviation of a tile's kernels over the distance of its samples, if that
/// distance exceeds a pixel. Chosen by hand; `SweepLod` tests bound its errors.
inline constexpr float kSigmasAStep = 0.7f;

/// Bits of the distance that splats are sorted by: two digits of 9 bits, whose counters fit into
/// the first-level cache.
inline constexpr int kKeyBits = 18;

/// Lens points matter only in tiles whose blur radius exceeds this, in distances of samples. Chosen
/// by hand.
inline constexpr float kBlurredSteps = 0.5f;

/// Blur radii in pixels. Up to the first a tile uses the whole aperture, from the second on
/// sub-apertures alone. In between it mixes both, so that a moving focus does not pop. Chosen by
/// hand; `ClosedSurfaces.FoliageWithALittleBlurIsAsViewsShowIt` bounds them.
inline constexpr float kSubAperturesFrom_px = 1.0f, kSubAperturesOnly_px = 2.0f;

// Layers.

/// A layer whose weights sum to more holds two surfaces. Chosen by hand, above the ripple of one
/// surface that `KernelSums` tests allow.
inline constexpr float kTwoSurfaces = 1.3f;

/// The mean lens point of a layer is scaled by the first and reduced by the second (lens radii)
/// before it bounds the layer's coverage. Chosen by hand: the mean then errs towards more coverage.
inline constexpr float kMeanScale = 0.92f, kMeanNoise = 0.04f;

/// A mean up to the second, over the first, bounds nothing: folds that hide parts of themselves
/// weigh one side of the lens more, although the surface covers all of it. At the mean of a
/// half-covered lens, 0.42, both bounds agree. `ClosedSurfaces` tests bound the rest.
inline constexpr float kFoldScale = 1.57f, kFoldMean = 0.314f;

/// The area share of the disc segment whose centroid lies m radii from the centre is
/// (1 - m) (1 - kSegmentBend m^2); a fit within 0.02.
inline constexpr float kSegmentBend = 0.7f;

/// The chord that cuts the share A off a disc lies -x (a x^12 + b x^4 + c) radii from the centre,
/// x = 2 A - 1; a polynomial fit.
inline constexpr float kChord12 = 0.065f, kChord4 = 0.15f, kChord0 = 0.785f;

/// The first moment of the half of a disc, over the disc's area and radius: 2 / (3 pi).
inline constexpr float kHalfDiscMoment = 0.2122066f;

}  // namespace foci
