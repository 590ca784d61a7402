// The layers of a tile's samples. An open layer sums splats; closing it composites its coverage and
// colour. Where the blur is large, a sample also remembers behind which edge on the lens its light
// is blocked. Included once a SIMD target.
#if defined(FOCI_LAYERS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FOCI_LAYERS_INL_H
#undef FOCI_LAYERS_INL_H
#else
#define FOCI_LAYERS_INL_H
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <cstddef>
#include <span>

#include "render/kernel/kernel.h"
#include "render/kernel/simd-inl.h"
#include "render/splat/block-inl.h"
#include "render/splat/constants.h"
#include "render/splat/edges-inl.h"
#include "render/splat/splat.h"

HWY_BEFORE_NAMESPACE();
namespace foci {
namespace HWY_NAMESPACE {

/// The layers of a tile.
template <bool kTransparent, bool kDepth, bool kLens>
struct Layers {
  static constexpr float kClosed = -1.0f;  // before any z-range
  static constexpr int kMaxBlocks = (kTile + 2 * kApron) / kBlock;

  Block tile[kMaxBlocks * kMaxBlocks];
  ColorSums beyond[kTransparent ? kMaxBlocks * kMaxBlocks : 1];  // see `addBeyond`
  const unsigned columns;                                        // of blocks; as many rows
  bool any_back_facing = false;                                  // in the open layers
  bool any_beyond = false;                                       // in the open layers
  unsigned translucent = 0;                                      // blocks that are not opaque
  bool overlap = false;  // somewhere layers cover each other in part

  const float coverage_a_weight;
  const CoverageRamp ramp;

  Layers(int samples_a_side, float coverage, const CoverageRamp& ramp_of_tile)
      : columns(static_cast<unsigned>(samples_a_side) / kBlock),
        coverage_a_weight(coverage),
        ramp(ramp_of_tile) {
    for (Block& block : blocks()) {
      block.facing = block.back_facing = Sums{};
      std::fill_n(block.far_m, kBlockSamples, kClosed);
    }
  }

  std::span<Block> blocks() { return {tile, columns * columns}; }

  /// Starts a new composite: nothing in it, all light passes.
  void clear() {
    for (Block& block : blocks()) {
      block.light = Light{};
      std::fill_n(block.light.transmittance, kBlockSamples, 1.0f);
      std::fill_n(block.light.outside, kBlockSamples, 1.0f);
      block.any_edge = block.opaque = false;
    }
    translucent = columns * columns;
  }

  /// Adds a splat's share that arrives after the open layer became opaque.
  /// @param weight  the share, times the light that reaches it
  HWY_NOINLINE void addBeyond(std::size_t index, std::size_t i, V weight, const Splat& splat) {
    const D d;
    if (!any_beyond) std::fill_n(beyond, columns * columns, ColorSums{});
    any_beyond = true;
    ColorSums& more = beyond[index];
    const auto add = [&](float* sum, float value) {
      hn::Store(hn::MulAdd(weight, hn::Set(d, value), hn::Load(d, sum + i)), d, sum + i);
    };
    const float opacity = std::abs(splat.opacity);
    add(more.red, splat.red);
    add(more.green, splat.green);
    add(more.blue, splat.blue);
    add(more.visible, opacity);
    if constexpr (kDepth) add(more.distance, 0.5f * (splat.near_m + splat.far_m) * opacity);
  }

  /// Divides what arrived beyond the opaque surface (see kNoise, kAnother): sampling noise joins
  /// the surface, the rest stays in `beyond` as a layer behind it.
  /// @param summed  weights of the facing sums; increased by the weights that join
  /// @return the weights that stay
  HWY_INLINE V joinBeyond(std::size_t index, std::size_t i, M which, V& summed) {
    const D d;
    Sums& side = tile[index].facing;
    ColorSums& more = beyond[index];
    const V weight =
        hn::Max(hn::Sub(hn::Load(d, side.weight + i), hn::Set(d, kOpaqueWeight)), hn::Zero(d));
    constexpr float kPer = 1.0f / (kAnother - kNoise);
    const V f = hn::MulAdd(weight, hn::Set(d, -kPer), hn::Set(d, kPer * kAnother));
    const V same = hn::Min(hn::Max(f, hn::Zero(d)), hn::Set(d, 1.0f));
    const auto join = [&](float* to, float* from) {
      const V value = hn::Load(d, from + i), sum = hn::Load(d, to + i);
      hn::Store(hn::IfThenElse(which, hn::MulAdd(same, value, sum), sum), d, to + i);
      hn::Store(hn::IfThenElse(which, hn::NegMulAdd(same, value, value), value), d, from + i);
    };
    join(side.red, more.red);
    join(side.green, more.green);
    join(side.blue, more.blue);
    join(side.visible, more.visible);
    if constexpr (kDepth) join(side.distance, more.distance);
    const V joins = hn::Mul(same, weight);
    summed = hn::Add(summed, joins);
    return hn::Sub(weight, joins);
  }

  /// Composites the open layers of the lanes in `which` from `i` on and opens new ones.
  HWY_NOINLINE void closeLayers(std::size_t index, std::size_t i, M which) {
    const D d;
    Block& block = tile[index];
    const V one = hn::Set(d, 1.0f);
    Closing closing{.light = block.light,
                    .i = i,
                    .which = which,
                    .transmittance = hn::Load(d, block.light.transmittance + i),
                    .alpha = hn::Zero(d),
                    .seen = one};

    // The side of the surface that faces the eye.
    Covering all = coveringOf<kLens>(block.facing, i, coverage_a_weight, ramp);
    if constexpr (kLens) findOverlap(block, i, which, all.weight, closing.transmittance);
    V summed = hn::Min(all.weight, hn::Set(d, kOpaqueWeight)), rest = hn::Zero(d);
    if constexpr (kTransparent) {
      if (any_beyond) rest = joinBeyond(index, i, which, summed);
    }
    const V facing = all.share;

    // The back of a solid meets its front at the outline, at one distance and within one layer, but
    // no ray sees both: the back counts where it lies beside the front.
    V back = hn::Zero(d), more = hn::Zero(d);
    if (any_back_facing) {
      const Covering other = coveringOf<kLens>(block.back_facing, i, coverage_a_weight, ramp);
      back = hn::Min(other.weight, hn::Set(d, kOpaqueWeight));
      more = besideFront(edgeOf(all), edgeOf(other));
      all.join(other, more);
    }
    if constexpr (!kLens) {
      if (block.any_edge) closing.seen = seenBehindPixelEdge(block.light, i, all);
    }
    closing.compositeLayer(block.facing, summed, facing);
    if (any_back_facing) closing.compositeLayer(block.back_facing, back, more);

    // The light that passes the layer, and the edge behind which it does.
    if constexpr (kLens) {
      closing.pass();
      findLensEdge(block, i, which, closing.transmittance);
    } else {
      findPixelEdge(block, i, which, all, closing);
      closing.pass();
    }
    if constexpr (kTransparent) {
      if (any_beyond) {
        closing.alpha = hn::Zero(d);
        closing.seen = one;
        closing.composite(beyond[index], rest, hn::Min(rest, one));
        closing.pass();
      }
    }
    hn::Store(closing.transmittance, d, block.light.transmittance + i);
    hn::Store(hn::IfThenElse(which, hn::Set(d, kClosed), hn::Load(d, block.far_m + i)), d,
              block.far_m + i);
  }

  /// Lanes whose layers close: their transmittance, and the alpha of the layer at hand.
  struct Closing {
    Light& light;
    const std::size_t i;
    const M which;
    V transmittance, alpha;
    V seen;  // share of the layer, over what an independent layer would show

    /// Reads a sum and resets it to zero in the lanes that close.
    HWY_INLINE V take(float* sum) const {
      const D d;
      const V value = hn::Load(d, sum + i);
      hn::Store(hn::IfThenZeroElse(which, value), d, sum + i);
      return value;
    }

    /// Composites sums over `summed` weights that cover `share` of the sample.
    /// @return the factor of the sums
    HWY_INLINE V composite(ColorSums& sums, V summed, V share) {
      const V scale = hn::Div(hn::Mul(share, seen), hn::Max(summed, hn::Set(D(), 1e-20f)));
      const V passed = hn::IfThenElseZero(which, hn::Mul(transmittance, scale));
      add(light.red, passed, sums.red);
      add(light.green, passed, sums.green);
      add(light.blue, passed, sums.blue);
      if constexpr (kDepth) add(light.distance, passed, sums.distance);
      alpha = hn::MulAdd(scale, kTransparent || kLens ? take(sums.visible) : summed, alpha);
      return passed;
    }

    HWY_INLINE void add(float* out, V factor, float* sum) const {
      const D d;
      hn::Store(hn::MulAdd(factor, take(sum), hn::Load(d, out + i)), d, out + i);
    }

    HWY_INLINE void compositeLayer(Sums& sums, V summed, V share) {
      const V passed = composite(sums, summed, share);
      if constexpr (kLens) {
        add(light.blocked_x, passed, sums.blocked_x);
        add(light.blocked_y, passed, sums.blocked_y);
        take(sums.lens_weight);
        take(sums.right);
        take(sums.above);
        take(sums.right_above);
      }
      take(sums.weight);
      take(sums.mean_x);
      take(sums.mean_y);
    }

    HWY_INLINE void pass() {
      const V one = hn::Set(D(), 1.0f);
      transmittance = hn::IfThenElse(
          which, hn::Mul(transmittance, hn::Sub(one, hn::Min(alpha, one))), transmittance);
    }
  };

  /// The straight edge on the lens behind which the closed layers block light.
  ///
  /// Layers that block the share A of the light up to an edge let it pass where n l < at. The unit
  /// vector n points to the mean lens point of the blocked light. A splat behind the layers then
  /// counts by the lens point that sees it (`edgeTransmittance`). All layers of a sample have one
  /// edge together: a fold that two sheets make, or the slices of one steep sheet, bound one
  /// region.
  HWY_INLINE void findLensEdge(Block& block, std::size_t i, M which, V transmittance) {
    const D d;
    const V one = hn::Set(d, 1.0f), tiny = hn::Set(d, 1e-6f);
    const V blocked = hn::Sub(one, transmittance), partial = hn::Set(d, kPartial);
    which = hn::And(which, hn::And(hn::Gt(blocked, partial), hn::Gt(transmittance, partial)));
    if (hn::AllFalse(d, which)) return;
    const V inv = hn::Div(one, blocked);
    const V mx = hn::Mul(hn::Load(d, block.light.blocked_x + i), inv);
    const V my = hn::Mul(hn::Load(d, block.light.blocked_y + i), inv);
    const V at = chordAt(blocked), length = hn::Sqrt(hn::MulAdd(mx, mx, hn::Mul(my, my)));
    const V share = straightness(length, blocked, at);

    // Transmittance on both sides of the edge, over the mean transmittance.
    const V contrast = hn::Div(share, transmittance);
    const V evenly = hn::Mul(hn::Sub(one, share), blocked);
    const V outside = hn::Div(hn::Sub(one, hn::Add(share, evenly)), transmittance);
    block.any_edge = true;
    const V inv_length = hn::Div(one, hn::Max(length, tiny));
    const auto keep = [&](float* to, V value) {
      hn::Store(hn::IfThenElse(which, value, hn::Load(d, to + i)), d, to + i);
    };
    keep(block.light.edge_x, hn::Mul(mx, inv_length));
    keep(block.light.edge_y, hn::Mul(my, inv_length));
    keep(block.light.edge_at, at);
    keep(block.light.outside, outside);
    keep(block.light.contrast, contrast);
  }

  /// The edge of one side of a layer, on the lens or in the pixel.
  static HWY_INLINE PixelEdges edgeOf(const Covering& side) {
    if constexpr (kLens) return lensEdgesOf(side.x, side.y, side.share);
    return pixelEdgesOf(side.weight, side.x, side.y, side.share);
  }

  /// How much more of a layer is seen than if it were independent of the layer at the sample's
  /// edge.
  HWY_INLINE V seenBehindPixelEdge(const Light& light, std::size_t i, const Covering& layer) const {
    const D d;
    const PixelEdges front{hn::Load(d, light.edge_at + i), hn::Load(d, light.edge_x + i),
                           hn::Load(d, light.edge_y + i)};
    return seenOverIndependent(front, hn::Load(d, light.outside + i), edgeOf(layer));
  }

  /// Keeps the edge of a closing layer that covers the sample in part, if it is the sample's
  /// strongest. The edge serves where two outlines meet in a pixel.
  HWY_INLINE void findPixelEdge(Block& block, std::size_t i, M which, const Covering& layer,
                                const Closing& closing) {
    const D d;
    const V one = hn::Set(d, 1.0f), tiny = hn::Set(d, 1e-6f);
    M better = hn::And(which, hn::And(hn::Gt(layer.share, hn::Set(d, kPartial)),
                                      hn::Lt(closing.alpha, hn::Set(d, 1.0f - kPartial))));
    if (hn::AllFalse(d, better)) return;
    const V independent = hn::Min(hn::Div(closing.alpha, hn::Max(closing.seen, tiny)), one);
    const V passes = hn::Max(hn::Sub(one, independent), hn::Set(d, 1e-3f));
    const V contrast = hn::Div(independent, passes);
    better = hn::And(better, hn::Gt(contrast, hn::Load(d, block.light.contrast + i)));
    if (hn::AllFalse(d, better)) return;
    block.any_edge = true;
    const PixelEdges edge = edgeOf(layer);
    const auto keep = [&](float* to, V value) {
      hn::Store(hn::IfThenElse(better, value, hn::Load(d, to + i)), d, to + i);
    };
    keep(block.light.edge_x, edge.x);
    keep(block.light.edge_y, edge.y);
    keep(block.light.edge_at, edge.share);
    keep(block.light.outside, hn::Min(hn::Div(independent, edge.share), one));
    keep(block.light.contrast, contrast);
  }

  /// Sets `overlap` where two layers cover a sample in part, or where one layer holds two surfaces.
  /// Such a sample needs sub-apertures: each point of the lens sees another surface there.
  HWY_INLINE void findOverlap(Block& block, std::size_t i, M which, V weight, V transmittance) {
    const D d;
    const V one = hn::Set(d, 1.0f), partial = hn::Load(d, block.light.partial + i);
    const V covered = hn::Min(weight, one);
    const V threshold = hn::Set(d, kPartial);
    M found = hn::Gt(hn::Mul(covered, partial), threshold);
    found = hn::Or(
        found, hn::And(hn::Gt(weight, hn::Set(d, kTwoSurfaces)), hn::Gt(transmittance, threshold)));
    overlap |= !hn::AllFalse(d, hn::And(which, found));
    const V here = hn::Mul(transmittance, hn::Min(covered, hn::Sub(one, covered)));
    hn::Store(hn::IfThenElse(which, hn::Max(partial, here), partial), d, block.light.partial + i);
  }

  HWY_INLINE void closeAll() {
    const D d;
    for (std::size_t index = 0; index < blocks().size(); ++index) {
      bool any_open = false;
      for (std::size_t i = 0; i < kBlockSamples; i += hn::Lanes(d)) {
        const M open = hn::Ge(hn::Load(d, tile[index].far_m + i), hn::Zero(d));
        if (hn::AllFalse(d, open)) continue;
        closeLayers(index, i, open);
        any_open = true;
      }
      if (any_open && !tile[index].opaque) becomesOpaque(tile[index]);
    }
    any_back_facing = any_beyond = false;
  }

  /// Whether a block that was not yet opaque now is: all of its transmittances are below kHidden.
  HWY_INLINE bool becomesOpaque(Block& block) {
    const D d;
    V max_transmittance = hn::Zero(d);
    for (std::size_t i = 0; i < kBlockSamples; i += hn::Lanes(d)) {
      max_transmittance = hn::Max(max_transmittance, hn::Load(d, block.light.transmittance + i));
    }
    block.opaque = hn::AllTrue(d, hn::Lt(max_transmittance, hn::Set(d, kHidden)));
    translucent -= block.opaque;
    return block.opaque;
  }
};

}  // namespace HWY_NAMESPACE
}  // namespace foci
HWY_AFTER_NAMESPACE();

#endif  // FOCI_LAYERS_INL_H
