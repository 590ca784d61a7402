// The straight edge of a layer that covers a part of the lens. Included once a SIMD target.
#if defined(FOCI_LENS_EDGE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FOCI_LENS_EDGE_INL_H
#undef FOCI_LENS_EDGE_INL_H
#else
#define FOCI_LENS_EDGE_INL_H
#endif

#include <hwy/highway.h>

#include "render/splat/constants.h"
#include "render/splat/pixel_edge-inl.h"
#include "render/splat/simd-inl.h"

HWY_BEFORE_NAMESPACE();
namespace foci {
namespace HWY_NAMESPACE {

/// Distance from the centre, in radii, of the chord that cuts the share A off a disc (`kChord12`).
HWY_INLINE V chordAt(V share) {
  const D d;
  const V x = hn::MulSub(hn::Set(d, 2.0f), share, hn::Set(d, 1.0f));
  const V x2 = hn::Mul(x, x), x4 = hn::Mul(x2, x2), x12 = hn::Mul(hn::Mul(x4, x4), x4);
  return hn::Neg(hn::Mul(x, hn::MulAdd(hn::Set(d, kChord12), x12,
                                       hn::MulAdd(hn::Set(d, kChord4), x4, hn::Set(d, kChord0)))));
}

/// How straight the edge of a layer is, 0 to 1.
///
/// A segment of the disc, up to a chord at the distance `at`, has the first moment
/// kHalfDiscMoment (1 - at^2)^(3/2) over the disc's area. The layer's moment over that one is the
/// share of the layer that is such a segment; the rest covers the lens evenly.
/// @param length  distance of the layer's mean lens point from the centre, lens radii
HWY_INLINE V straightness(V length, V share, V at) {
  const D d;
  const V one = hn::Set(d, 1.0f), c = hn::Max(hn::NegMulAdd(at, at, one), hn::Zero(d));
  const V moment = hn::Mul(hn::Set(d, kHalfDiscMoment), hn::Mul(c, hn::Sqrt(c)));
  return hn::Min(hn::Div(hn::Mul(length, share), hn::Max(moment, hn::Set(d, 1e-6f))), one);
}

/// The direction of a layer's edge on the lens, as of one in a pixel.
/// @param x, y  mean lens point, lens radii
HWY_INLINE PixelEdges lensEdgesOf(V x, V y, V share) {
  const D d;
  const V length = hn::Sqrt(hn::MulAdd(x, x, hn::Mul(y, y)));
  const V scale =
      hn::Div(straightness(length, share, chordAt(share)), hn::Max(length, hn::Set(d, 1e-6f)));
  return {share, hn::Mul(x, scale), hn::Mul(y, scale)};
}

}  // namespace HWY_NAMESPACE
}  // namespace foci
HWY_AFTER_NAMESPACE();

#endif  // FOCI_LENS_EDGE_INL_H
