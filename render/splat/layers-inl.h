// The open and the closed layers of a tile's samples: what splats sum up to, what it covers, and
// which side of the lens the light that passes it falls on. Included once a SIMD target.
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

#include "render/kernel/limits.h"
#include "render/splat/bin.h"
#include "render/splat/splat.h"

#ifndef FOCI_LAYERS_ONCE
#define FOCI_LAYERS_ONCE
namespace foci {

/// Coverage that tells a layer from nothing, or from a whole one, when looking for layers that
/// cover each other in part.
inline constexpr float kPartial = 0.02f;

/// Sums of weights that a single surface does not reach: two were taken for one.
inline constexpr float kTooMuch = 1.3f;

/// What the mean of a layer's lens points may be off by, of itself and in radii: a little more than
/// the kernels that it is found by.
inline constexpr float kMeanScale = 0.92f, kMeanNoise = 0.04f;

}  // namespace foci
#endif  // FOCI_LAYERS_ONCE

HWY_BEFORE_NAMESPACE();
namespace foci {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, 16>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;

// A tile is blocks of 4 x 4 samples; a block's 16 are consecutive, row by row.
constexpr int kBlock = 4, kBlockSamples = kBlock * kBlock;
static_assert(kTile % (kBlock * kMaxStep_px) == 0 && 2 * kApron % kBlock == 0);
using BlockValues = float[kBlockSamples];

/// Per sample, colours summed over splats by their weights. `visible`, the opacity that is seen,
/// and `distance` are used where asked for.
struct alignas(64) Paint {
  BlockValues red, green, blue, visible, distance;
};

/// An open layer: of the splats that came before it was whole.
struct alignas(64) Sums : Paint {
  BlockValues weight;          // of all, what came later too
  BlockValues lens_x, lens_y;  // weights times lens points
};

/// Per sample, what is composited, and what light still passes.
struct alignas(64) Light {
  BlockValues through;
  BlockValues red, green, blue, distance;
  BlockValues partial;                  // the most that a layer covers a part of the light
  BlockValues side_x, side_y, side_at;  // see `findSide`
  BlockValues outside, contrast;
};

/// All of a block lies together: arrays by tile, a power of two apart, would share the same few
/// cache lines.
struct alignas(64) Block {
  Sums facing, from_behind;  // of the open layer, by the side that is seen
  BlockValues far_m;         // where its z-range ends
  Light light;
  bool any_side;  // some light that passes has a side of the lens
  bool dark;      // none passes any more
};

/// The layers of a tile.
template <bool kTransparent, bool kDepth, bool kLens>
struct Layers {
  static constexpr float kClosed = -1.0f;  // before any z-range
  static constexpr int kMaxBlocks = (kTile + 2 * kApron) / kBlock;

  Block tile[kMaxBlocks * kMaxBlocks];
  Paint beyond[kTransparent ? kMaxBlocks * kMaxBlocks : 1];  // what came later, see `addBeyond`
  const unsigned columns;                                    // of blocks, and their rows
  bool any_from_behind = false;                              // in the open layers
  bool any_beyond = false;                                   // likewise
  unsigned lit = 0;                                          // blocks that some light passes
  bool overlap = false;  // somewhere layers cover each other in part

  explicit Layers(int samples_a_side) : columns(static_cast<unsigned>(samples_a_side) / kBlock) {
    for (Block& block : blocks()) {
      block.facing = block.from_behind = Sums{};
      std::fill_n(block.far_m, kBlockSamples, kClosed);
    }
  }

  std::span<Block> blocks() { return {tile, columns * columns}; }

  /// Nothing composited yet: all light passes.
  void clear() {
    for (Block& block : blocks()) {
      block.light = Light{};
      std::fill_n(block.light.through, kBlockSamples, 1.0f);
      std::fill_n(block.light.outside, kBlockSamples, 1.0f);
      block.any_side = block.dark = false;
    }
    lit = columns * columns;
  }

  /// Adds what comes once the surface of a layer is whole.
  /// @param weight  of it, times the light that passes to it
  HWY_NOINLINE void addBeyond(std::size_t index, std::size_t i, V weight, const Splat& splat) {
    const D d;
    if (!any_beyond) std::fill_n(beyond, columns * columns, Paint{});
    any_beyond = true;
    Paint& more = beyond[index];
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

  /// What came beyond a whole surface is, where it is little, noise of the same surface and joins
  /// it; the rest stays, to be composited behind it.
  /// @param summed  weights of `side`'s sums, enlarged by what joins; returns those of the rest
  HWY_INLINE V joinBeyond(std::size_t index, std::size_t i, M which, V& summed) {
    const D d;
    Sums& side = tile[index].facing;
    Paint& more = beyond[index];
    const V weight =
        hn::Max(hn::Sub(hn::Load(d, side.weight + i), hn::Set(d, kWhole)), hn::Zero(d));
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
    V through = hn::Load(d, block.light.through + i);
    V alpha = hn::Zero(d);

    const auto take = [&](float* sum) {
      const V value = hn::Load(d, sum + i);
      hn::Store(hn::IfThenZeroElse(which, value), d, sum + i);
      return value;
    };
    // What a side covers, and its mean point on the lens.
    const auto cover = [&](const Sums& sums) {
      const V weight = hn::Load(d, sums.weight + i);
      // `coverageOf`
      constexpr Ripple kRipple = kLens ? kBlurredRipple : kSharpRipple;
      const V steep = hn::MulAdd(weight, hn::Set(d, kRipple.slope()),
                                 hn::Set(d, kRipple.part - kRipple.slope() * kRipple.part));
      Covering c{weight, hn::Min(hn::Max(weight, steep), one), hn::Zero(d), hn::Zero(d)};
      if constexpr (kLens) {
        const V summed = hn::Min(weight, hn::Set(d, kWhole));
        const V inv = hn::Div(one, hn::Max(summed, hn::Set(d, 1e-20f)));
        c.x = hn::Mul(hn::Load(d, sums.lens_x + i), inv);
        c.y = hn::Mul(hn::Load(d, sums.lens_y + i), inv);
        c.share = hn::Min(c.share, shareAt(hn::Sqrt(hn::MulAdd(c.x, c.x, hn::Mul(c.y, c.y)))));
      }
      return c;
    };
    // `share` of the sample is this side's, `summed` the weights that its sums are of.
    const auto render = [&](Paint& sums, V summed, V share) {
      const V scale = hn::Div(share, hn::Max(summed, hn::Set(d, 1e-20f)));
      const V passed = hn::IfThenElseZero(which, hn::Mul(through, scale));
      const auto compose = [&](float* out, float* sum) {
        hn::Store(hn::MulAdd(passed, take(sum), hn::Load(d, out + i)), d, out + i);
      };
      compose(block.light.red, sums.red);
      compose(block.light.green, sums.green);
      compose(block.light.blue, sums.blue);
      if constexpr (kDepth) compose(block.light.distance, sums.distance);
      alpha = hn::MulAdd(scale, kTransparent || kLens ? take(sums.visible) : summed, alpha);
    };
    const auto composeSide = [&](Sums& sums, V summed, V share) {
      render(sums, summed, share);
      take(sums.weight);
      if constexpr (kLens) {
        take(sums.lens_x);
        take(sums.lens_y);
      }
    };

    Covering all = cover(block.facing);
    if constexpr (kLens) lookForOverlap(block, i, which, all.weight, through);
    V summed = hn::Min(all.weight, hn::Set(d, kWhole)), rest = hn::Zero(d);
    if constexpr (kTransparent) {
      if (any_beyond) rest = joinBeyond(index, i, which, summed);
    }
    composeSide(block.facing, summed, all.share);
    if (any_from_behind) {
      // The far side of a solid meets the near side at its outline, at one distance and within one
      // layer, but no ray sees both: it counts where it covers more than the near side does.
      const Covering behind = cover(block.from_behind);
      const V left = hn::Max(hn::Sub(behind.share, all.share), hn::Zero(d));
      composeSide(block.from_behind, hn::Min(behind.weight, hn::Set(d, kWhole)), left);
      if constexpr (kLens) {
        const V total = hn::Add(all.share, left);
        const V f = hn::Div(left, hn::Max(total, hn::Set(d, 1e-20f)));
        all.x = hn::MulAdd(f, hn::Sub(behind.x, all.x), all.x);
        all.y = hn::MulAdd(f, hn::Sub(behind.y, all.y), all.y);
        all.share = total;
      }
    }
    const auto pass = [&] {
      through = hn::IfThenElse(which, hn::Mul(through, hn::Sub(one, hn::Min(alpha, one))), through);
    };
    if constexpr (kLens) findSide(block, i, which, all, hn::Min(alpha, one));
    pass();
    if constexpr (kTransparent) {
      if (any_beyond) {
        alpha = hn::Zero(d);
        render(beyond[index], rest, hn::Min(rest, one));
        pass();
      }
    }
    hn::Store(through, d, block.light.through + i);
    hn::Store(hn::IfThenElse(which, hn::Set(d, kClosed), hn::Load(d, block.far_m + i)), d,
              block.far_m + i);
  }

  /// What of the lens a layer covers.
  struct Covering {
    V weight;  // sum of the kernels
    V share;   // of the lens, at most 1
    V x, y;    // mean point on the lens, lens radii
  };

  /// The share of a disc that a chord cuts off whose centroid lies `mean` radii from the centre:
  /// within 0.02. A layer that covers one side of the lens cannot cover more than that, though its
  /// kernels may sum up to more where it hides parts of itself.
  static HWY_INLINE V shareAt(V mean) {
    const D d;
    const V one = hn::Set(d, 1.0f),
            m = hn::Min(hn::Max(hn::MulSub(mean, hn::Set(d, kMeanScale), hn::Set(d, kMeanNoise)),
                                hn::Zero(d)),
                        one);
    return hn::Mul(hn::Sub(one, m), hn::NegMulAdd(hn::Set(d, 0.7f), hn::Mul(m, m), one));
  }

  /// The side of the lens that a closing layer covers. A layer that covers the share A of the lens
  /// about an edge leaves the light of a half of it, { l : n l < at }; n points
  /// to the mean l of what it covers, and how far off that mean lies, of what it would if the edge
  /// were straight, tells how much of the layer is such a half and how much covers evenly.
  /// A splat further behind counts by where on the lens it is seen. One side is kept a sample, the
  /// one of the most contrast.
  HWY_INLINE void findSide(Block& block, std::size_t i, M which, const Covering& layer, V alpha) {
    const D d;
    const V one = hn::Set(d, 1.0f), tiny = hn::Set(d, 1e-6f), zero = hn::Zero(d);
    const V covering = layer.share, mx = layer.x, my = layer.y;

    // The chord that cuts off the share A of a disc lies at about this distance from its centre.
    const V x = hn::MulSub(hn::Set(d, 2.0f), covering, one);
    const V x2 = hn::Mul(x, x), x4 = hn::Mul(x2, x2), x12 = hn::Mul(hn::Mul(x4, x4), x4);
    const V at =
        hn::Neg(hn::Mul(x, hn::MulAdd(hn::Set(d, 0.065f), x12,
                                      hn::MulAdd(hn::Set(d, 0.15f), x4, hn::Set(d, 0.785f)))));
    // First moment of that part over the disc's area: 2 / (3 pi) (1 - at^2)^(3/2).
    const V c = hn::Max(hn::NegMulAdd(at, at, one), zero);
    const V straight = hn::Mul(hn::Set(d, 0.2122066f), hn::Mul(c, hn::Sqrt(c)));
    const V length = hn::Sqrt(hn::MulAdd(mx, mx, hn::Mul(my, my)));
    const V share = hn::Min(hn::Div(hn::Mul(length, covering), hn::Max(straight, tiny)), one);

    const V passes = hn::Max(hn::Sub(one, alpha), hn::Set(d, 1e-3f));
    const V opaque = hn::Min(hn::Div(alpha, hn::Max(covering, tiny)), one);
    const V contrast = hn::Div(hn::Mul(opaque, share), passes);
    const V evenly = hn::Mul(hn::Sub(one, share), covering);
    const V outside = hn::Div(hn::NegMulAdd(opaque, hn::Add(share, evenly), one), passes);
    M better = hn::And(which, hn::Gt(contrast, hn::Load(d, block.light.contrast + i)));
    better = hn::And(better, hn::And(hn::Gt(covering, hn::Set(d, kPartial)),
                                     hn::Lt(alpha, hn::Set(d, 1.0f - kPartial))));
    if (hn::AllFalse(d, better)) return;
    block.any_side = true;
    const V inv_length = hn::Div(one, hn::Max(length, tiny));
    const auto keep = [&](float* to, V value) {
      hn::Store(hn::IfThenElse(better, value, hn::Load(d, to + i)), d, to + i);
    };
    keep(block.light.side_x, hn::Mul(mx, inv_length));
    keep(block.light.side_y, hn::Mul(my, inv_length));
    keep(block.light.side_at, at);
    keep(block.light.outside, outside);
    keep(block.light.contrast, contrast);
  }

  /// Notes where the light that one layer covers in part falls on another, and where one layer
  /// holds more than a surface. What a lens sees there hangs on where it covers.
  HWY_INLINE void lookForOverlap(Block& block, std::size_t i, M which, V weight, V through) {
    const D d;
    const V one = hn::Set(d, 1.0f), partial = hn::Load(d, block.light.partial + i);
    const V covered = hn::Min(weight, one);
    const V least = hn::Set(d, kPartial);
    M found = hn::Gt(hn::Mul(covered, partial), least);
    found = hn::Or(found, hn::And(hn::Gt(weight, hn::Set(d, kTooMuch)), hn::Gt(through, least)));
    overlap |= !hn::AllFalse(d, hn::And(which, found));
    const V here = hn::Mul(through, hn::Min(covered, hn::Sub(one, covered)));
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
      if (any_open && !tile[index].dark) goesDark(tile[index]);
    }
    any_from_behind = any_beyond = false;
  }

  /// Whether hardly any light passes a block that did not yet count as dark; it stays so.
  HWY_INLINE bool goesDark(Block& block) {
    const D d;
    V most = hn::Zero(d);
    for (std::size_t i = 0; i < kBlockSamples; i += hn::Lanes(d)) {
      most = hn::Max(most, hn::Load(d, block.light.through + i));
    }
    block.dark = hn::AllTrue(d, hn::Lt(most, hn::Set(d, kHidden)));
    lit -= block.dark;
    return block.dark;
  }
};

}  // namespace HWY_NAMESPACE
}  // namespace foci
HWY_AFTER_NAMESPACE();

#endif  // FOCI_LAYERS_INL_H
