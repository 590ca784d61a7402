// A block of samples: the sums of its open layers, its light, and how much of the lens, or of the
// pixel, a layer covers. Included once a SIMD target.
#if defined(FOCI_BLOCK_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FOCI_BLOCK_INL_H
#undef FOCI_BLOCK_INL_H
#else
#define FOCI_BLOCK_INL_H
#endif

#include <hwy/highway.h>

#include <cstddef>

#include "render/kernel/kernel.h"
#include "render/kernel/simd-inl.h"
#include "render/splat/bin.h"
#include "render/splat/constants.h"
#include "render/splat/edges-inl.h"

HWY_BEFORE_NAMESPACE();
namespace foci {
namespace HWY_NAMESPACE {

// A tile is blocks of 4 x 4 samples; a block's 16 are consecutive, row by row.
constexpr int kBlock = 4, kBlockSamples = kBlock * kBlock;
static_assert(kTile % (kBlock * kMaxStep_px) == 0 && 2 * kApron % kBlock == 0);
using BlockValues = float[kBlockSamples];

/// By sample, colours of splats times their weights. `visible` sums the opacity that is seen and
/// `distance` the distances, where the sweep needs them.
struct alignas(64) ColorSums {
  BlockValues red, green, blue, visible, distance;
};

/// An open layer. The colours are those of splats that arrived before the layer was opaque.
struct alignas(64) Sums : ColorSums {
  BlockValues weight;       // of all splats, later ones too
  BlockValues lens_weight;  // of all splats, without their tilt
  // `lens_weight` times lens points; without a lens, `weight` times the centres' offsets over the
  // supports' radii.
  BlockValues mean_x, mean_y;
  // `lens_weight` by the lens points of each splat with x > 0, with y > 0, and with both; unused
  // without a lens.
  BlockValues right, above, right_above;
  BlockValues blocked_x, blocked_y;  // `visible` times lens points; unused without a lens
};

/// By sample, the composited light and the transmittance of all closed layers.
struct alignas(64) Light {
  BlockValues transmittance;
  BlockValues red, green, blue, distance;
  BlockValues blocked_x, blocked_y;  // lens points times the share of the light blocked there
  BlockValues partial;               // largest share of the light that a layer covers in part
  // An edge: of all layers on the lens (`findLensEdge`), or of most contrast in the pixel
  // (`findPixelEdge`).
  // Beyond a lens's edge `outside` passes; of a pixel's edge `outside` is the opacity and `edge_at`
  // the share.
  BlockValues edge_x, edge_y, edge_at, outside;
  BlockValues contrast;  // step of the transmittance at the edge, over the mean
};

/// The data of a block lie together. Arrays over the tile would lie a power of two apart and
/// compete for the same few cache lines.
struct alignas(64) Block {
  Sums facing, back_facing;  // the open layer, by the side of the surface that is seen
  BlockValues far_m;         // end of the open layer's z-range
  Light light;
  bool any_edge;  // some sample has an edge
  bool opaque;    // no sample passes light any more
};

/// The coverage of a layer, or of one side of its surface.
struct Covering {
  V weight;  // sum of the kernels
  V share;   // of the lens or the pixel, at most 1
  V x, y;    // mean lens point of the layer, lens radii; or mean offset of its kernels

  /// Adds another side that covers `more`.
  HWY_INLINE void join(const Covering& other, V more) {
    weight = hn::Max(weight, other.weight);
    const V total = hn::Add(share, more);
    const V f = hn::Div(more, hn::Max(total, hn::Set(D(), 1e-20f)));
    x = hn::MulAdd(f, hn::Sub(other.x, x), x);
    y = hn::MulAdd(f, hn::Sub(other.y, y), y);
    share = total;
  }
};

/// `coverageOf`, by lane.
HWY_INLINE V shareOf(V weight, V coverage_a_weight, const CoverageRamp& ramp) {
  const D d;
  const V steep = hn::MulAdd(weight, hn::Set(d, ramp.slope()),
                             hn::Set(d, ramp.linear_to - ramp.slope() * ramp.linear_to));
  return hn::Min(hn::Max(hn::Mul(weight, coverage_a_weight), steep), hn::Set(d, 1.0f));
}

/// Area share of the disc segment whose centroid lies `mean` radii from the centre
/// (`kSegmentBend`).
HWY_INLINE V segmentShare(V mean) {
  const D d;
  const V one = hn::Set(d, 1.0f);
  const V straight = hn::MulSub(mean, hn::Set(d, kMeanScale), hn::Set(d, kMeanNoise));
  const V folded = hn::MulSub(mean, hn::Set(d, kFoldScale), hn::Set(d, kFoldMean));
  const V m = hn::Min(hn::Max(hn::Min(straight, folded), hn::Zero(d)), one);
  return hn::Mul(hn::Sub(one, m), hn::NegMulAdd(hn::Set(d, kSegmentBend), hn::Mul(m, m), one));
}

/// The weight of a layer if no quarter of the lens counts for more than a quarter.
/// @param scale  factor on the sums of lens points
HWY_INLINE V weightByQuarters(const Sums& sums, std::size_t i, V scale) {
  const D d;
  const V all = hn::Load(d, sums.lens_weight + i), right = hn::Load(d, sums.right + i);
  const V above = hn::Load(d, sums.above + i), both = hn::Load(d, sums.right_above + i);
  const auto quarter = [&](V sum) { return hn::Min(hn::Mul(sum, scale), hn::Set(d, 0.25f)); };
  const V neither = hn::Max(hn::Sub(hn::Add(all, both), hn::Add(right, above)), hn::Zero(d));
  return hn::Add(hn::Add(quarter(both), quarter(hn::Sub(right, both))),
                 hn::Add(quarter(hn::Sub(above, both)), quarter(neither)));
}

/// The coverage of one side of a layer.
///
/// Where a layer hides parts of itself, its kernels sum to more than it covers. Two bounds know
/// that: a layer on one side of the lens covers no more than the segment with its mean lens point,
/// and no quarter of the lens counts for more than a quarter. Folds on one side of a covered lens
/// shift the mean, and uneven sampling leaves quarters open, so the larger bound holds.
template <bool kLens>
HWY_INLINE Covering coveringOf(const Sums& sums, std::size_t i, float coverage_a_weight,
                               const CoverageRamp& ramp) {
  const D d;
  const V weight = hn::Load(d, sums.weight + i), per = hn::Set(d, coverage_a_weight);
  const float* const summed = kLens ? sums.lens_weight : sums.weight;
  const V inv = hn::Div(hn::Set(d, 1.0f), hn::Max(hn::Load(d, summed + i), hn::Set(d, 1e-20f)));
  Covering c{.weight = weight,
             .share = shareOf(weight, per, ramp),
             .x = hn::Mul(hn::Load(d, sums.mean_x + i), inv),
             .y = hn::Mul(hn::Load(d, sums.mean_y + i), inv)};
  const V length = hn::Sqrt(hn::MulAdd(c.x, c.x, hn::Mul(c.y, c.y)));
  if constexpr (kLens) {
    const V segment = segmentShare(length);
    const V quarters = shareOf(weightByQuarters(sums, i, hn::Mul(weight, inv)), per, ramp);
    c.share = hn::Min(c.share, hn::Max(quarters, hn::Mul(segment, per)));
  } else {  // `pixelCoverageOf`
    const V straight = straightnessOf(weight, length), closed = shareOf(weight, per, kHoleRamp);
    const V square = hn::Mul(straight, straight);
    c.share = hn::MulAdd(hn::Mul(square, square), hn::Sub(c.share, closed), closed);
  }
  return c;
}

}  // namespace HWY_NAMESPACE
}  // namespace foci
HWY_AFTER_NAMESPACE();

#endif  // FOCI_BLOCK_INL_H
