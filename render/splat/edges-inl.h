// The edges of render/kernel/pixel_edge.h, for as many samples as SIMD lanes, and the straight edge
// of a layer that covers a part of the lens. Included once a SIMD target.
#if defined(FOCI_EDGES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FOCI_EDGES_INL_H
#undef FOCI_EDGES_INL_H
#else
#define FOCI_EDGES_INL_H
#endif

#include <hwy/highway.h>

#include <cmath>

#include "render/kernel/kernel.h"
#include "render/kernel/pixel_edge.h"
#include "render/kernel/simd-inl.h"
#include "render/splat/constants.h"

HWY_BEFORE_NAMESPACE();
namespace foci {
namespace HWY_NAMESPACE {

/// `PixelEdge`, by lane.
struct PixelEdges {
  V share, x, y;
};

/// `straightness`, by lane.
HWY_INLINE V straightnessOf(V weight, V length) {
  const D d;
  const V one = hn::Set(d, 1.0f), tiny = hn::Set(d, 1e-6f), area = hn::Min(weight, one);
  const V u = hn::Mul(hn::Mul(hn::Set(d, 4.0f), area), hn::Sub(one, area));
  const V bent = hn::MulAdd(u, hn::Set(d, -kDensityBend), hn::Set(d, 1.0f + kDensityBend));
  const V density = hn::Mul(hn::Mul(hn::Set(d, kDensityPeak), u), bent);
  const V measured = hn::Mul(hn::Mul(hn::Set(d, std::sqrt(kWidestSupport2)), length), area);
  return hn::Min(hn::Div(measured, hn::Max(density, tiny)), one);
}

/// `pixelEdgeOf`, by lane.
HWY_INLINE PixelEdges pixelEdgesOf(V weight, V x, V y, V share) {
  const V length = hn::Sqrt(hn::MulAdd(x, x, hn::Mul(y, y)));
  const V scale = hn::Div(straightnessOf(weight, length), hn::Max(length, hn::Set(D(), 1e-6f)));
  return {share, hn::Mul(x, scale), hn::Mul(y, scale)};
}

/// `apart`, by lane.
HWY_INLINE V apart(const PixelEdges& a, const PixelEdges& b) {
  const D d;
  const V cosine = hn::MulAdd(a.x, b.x, hn::Mul(a.y, b.y));
  const V r = hn::Max(hn::Neg(cosine), hn::Zero(d));
  const V r2 = hn::Mul(r, r), r4 = hn::Mul(r2, r2);
  return hn::Mul(r, hn::MulAdd(hn::Mul(r4, r4), hn::Set(d, 1.0f - kArcSine), hn::Set(d, kArcSine)));
}

/// `leastShared`, by lane.
HWY_INLINE V leastShared(const PixelEdges& a, const PixelEdges& b) {
  const D d;
  return hn::Max(hn::Sub(hn::Add(a.share, b.share), hn::Set(d, 1.0f)), hn::Zero(d));
}

/// `sharedBy`, by lane.
HWY_INLINE V sharedBy(const PixelEdges& a, const PixelEdges& b) {
  const V independent = hn::Mul(a.share, b.share);
  return hn::MulAdd(apart(a, b), hn::Sub(leastShared(a, b), independent), independent);
}

/// `besideFront`, by lane.
HWY_INLINE V besideFront(const PixelEdges& front, const PixelEdges& back) {
  const V hidden = hn::Min(front.share, back.share);
  const V f = apart(front, back);
  return hn::Sub(back.share, hn::MulAdd(f, hn::Sub(leastShared(front, back), hidden), hidden));
}

/// `seenOverIndependent`, by lane.
HWY_INLINE V seenOverIndependent(const PixelEdges& front, V opacity, const PixelEdges& behind) {
  const D d;
  const V seen = hn::NegMulAdd(opacity, sharedBy(front, behind), behind.share);
  const V passes = hn::NegMulAdd(opacity, front.share, hn::Set(d, 1.0f));
  return hn::Div(seen, hn::Max(hn::Mul(passes, behind.share), hn::Set(d, 1e-6f)));
}

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

#endif  // FOCI_EDGES_INL_H
