#include "render/splat/sweep.h"

#include <hwy/cache_control.h>
#include "app/base/parallel.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "render/splat/interpolate.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/splat/sweep.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef FOCI_SWEEP_ONCE
#define FOCI_SWEEP_ONCE
namespace foci {

/// Light that passes a tile below this is not worth another layer: half a step of an 8-bit
/// picture's darkest, linear, code.
inline constexpr float kHidden = 1.0f / 8192.0f;

/// Coverage that tells a layer from nothing, or from a whole one, when looking for layers that
/// cover each other in part.
inline constexpr float kPartial = 0.02f;

/// Sums of weights that a single surface does not reach: two were taken for one.
inline constexpr float kTooMuch = 1.3f;

/// How fast a layer whose weights have reached one shuts: at 1 + 1 / kCloses nothing more joins it.
inline constexpr float kCloses = 2.0f;

/// What the mean of a layer's lens points may be off by, of itself and in radii: a little more than
/// the kernels that it is found by.
inline constexpr float kMeanScale = 0.92f, kMeanNoise = 0.04f;

/// Less blur than this makes no difference to what hides what, pixels.
inline constexpr float kBlurred_px = 0.5f;

/// Less blur than this needs no parts of the lens, pixels.
inline constexpr float kPartsFrom_px = 3.0f;

struct TileJob {
  const Splat* splats;
  const std::uint32_t* entries;
  std::size_t count;
  float x, y;            // of the first sample, pixels
  float lens_x, lens_y;  // what a mean radius counts along the axes, where pixels are oblong
  float per_step;        // 1 / the distance of samples, pixels
  float background[3];
  const SplatLens* lens;  // null: nothing is blurred
  glm::vec2 radius_px_per_D;
  const LensParts* parts;  // null: never by parts
  glm::vec4* rgba;         // kSide x kSide samples of the tile
  float* depth_m;          // likewise; null: not asked for
};

}  // namespace foci
#endif  // FOCI_SWEEP_ONCE

HWY_BEFORE_NAMESPACE();
namespace foci {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, 16>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;

// A tile is blocks of 4 x 4 samples; a block's 16 are consecutive, row by row.
constexpr int kBlock = 4, kBlockSamples = kBlock * kBlock;
static_assert(kTile % kBlock == 0 && 2 * kApron % kBlock == 0);

/// Per sample, sums over the splats of an open layer. `visible`, the opacity that is seen, and
/// `distance` are used where asked for.
template <int kSamples>
struct Sums {
  alignas(64) float weight[kSamples], red[kSamples], green[kSamples], blue[kSamples];
  alignas(64) float visible[kSamples], distance[kSamples];
  alignas(64) float lens_x[kSamples], lens_y[kSamples];  // weights times lens points
};

/// Per sample: the open layer and what is already composited.
template <int kSamples>
struct TileState {
  Sums<kSamples> facing, from_behind;   // the layer's surfaces by the side that is seen
  alignas(64) float far_m[kSamples];    // where its z-range ends
  alignas(64) float through[kSamples];  // light that still passes
  alignas(64) float out_red[kSamples], out_green[kSamples], out_blue[kSamples],
      out_distance[kSamples];
  alignas(64) float partial[kSamples];  // the most that a layer covers a part of the light
  alignas(64) float side_x[kSamples], side_y[kSamples], side_at[kSamples];  // see `LensSide`
  alignas(64) float outside[kSamples], contrast[kSamples];
};

/// Where the samples of a tile lie, from the first, in the order of `TileState`.
template <int kSide>
struct Places {
  alignas(64) float x[kSide * kSide], y[kSide * kSide];
  constexpr Places() : x(), y() {
    for (int i = 0; i < kSide * kSide; ++i) {
      const int block = i / kBlockSamples, sample = i % kBlockSamples;
      x[i] = static_cast<float>(block % (kSide / kBlock) * kBlock + sample % kBlock);
      y[i] = static_cast<float>(block / (kSide / kBlock) * kBlock + sample / kBlock);
    }
  }
};
template <int kSide>
constexpr Places<kSide> kPlaces;

/// A tile of kSide x kSide samples.
template <int kSide, bool kTransparent, bool kDepth, bool kLens>
struct Sweep {
  static constexpr int kSamples = kSide * kSide, kBlocks = kSide / kBlock;
  using Sums = HWY_NAMESPACE::Sums<kSamples>;

  TileState<kSamples> tile;
  bool any_from_behind = false;  // in the open layers
  bool any_side = false;         // some light that passes has a side of the lens
  bool overlap = false;          // somewhere layers cover each other in part

  /// Composites the open layers of the samples `i + lane` in `which` and opens new ones.
  HWY_NOINLINE void closeLayers(std::size_t i, M which) {
    const D d;
    const V one = hn::Set(d, 1.0f);
    const V through = hn::Load(d, tile.through + i);
    V alpha = hn::Zero(d);

    // What a side covers, and its mean point on the lens.
    const auto cover = [&](const Sums& sums) {
      Covering c;
      c.weight = hn::Load(d, sums.weight + i);
      c.share = hn::Min(c.weight, one);
      if constexpr (kLens) {
        const V inv = hn::Div(one, hn::Max(c.weight, hn::Set(d, 1e-20f)));
        c.x = hn::Mul(hn::Load(d, sums.lens_x + i), inv);
        c.y = hn::Mul(hn::Load(d, sums.lens_y + i), inv);
        c.share = hn::Min(c.share, shareAt(hn::Sqrt(hn::MulAdd(c.x, c.x, hn::Mul(c.y, c.y)))));
      }
      return c;
    };
    // `share` of the sample is this side's. Colours and opacities, sums over the weights, scale
    // alike.
    const auto composeSide = [&](Sums& sums, const Covering& c, V share) {
      const V scale = hn::Div(share, hn::Max(c.weight, hn::Set(d, 1e-20f)));
      const V passed = hn::IfThenElseZero(which, hn::Mul(through, scale));
      const auto take = [&](float* sum) {
        const V value = hn::Load(d, sum + i);
        hn::Store(hn::IfThenZeroElse(which, value), d, sum + i);
        return value;
      };
      const auto compose = [&](float* out, float* sum) {
        hn::Store(hn::MulAdd(passed, take(sum), hn::Load(d, out + i)), d, out + i);
      };
      compose(tile.out_red, sums.red);
      compose(tile.out_green, sums.green);
      compose(tile.out_blue, sums.blue);
      if constexpr (kDepth) compose(tile.out_distance, sums.distance);
      V opaque = take(sums.weight);
      if constexpr (kTransparent || kLens) opaque = take(sums.visible);
      if constexpr (kLens) {
        take(sums.lens_x);
        take(sums.lens_y);
      }
      alpha = hn::MulAdd(scale, opaque, alpha);
    };

    Covering all = cover(tile.facing);
    lookForOverlap(i, which, all.weight, through);
    composeSide(tile.facing, all, all.share);
    if (any_from_behind) {
      // The far side of a solid meets the near side at its outline, at one distance and within one
      // layer, but no ray sees both: it counts where it covers more than the near side does.
      const Covering behind = cover(tile.from_behind);
      const V left = hn::Max(hn::Sub(behind.share, all.share), hn::Zero(d));
      composeSide(tile.from_behind, behind, left);
      if constexpr (kLens) {
        const V total = hn::Add(all.share, left);
        const V f = hn::Div(left, hn::Max(total, hn::Set(d, 1e-20f)));
        all.x = hn::MulAdd(f, hn::Sub(behind.x, all.x), all.x);
        all.y = hn::MulAdd(f, hn::Sub(behind.y, all.y), all.y);
        all.share = total;
      }
    }
    alpha = hn::Min(alpha, one);
    if constexpr (kLens) findSide(i, which, all, alpha);
    hn::Store(hn::IfThenElse(which, hn::Mul(through, hn::Sub(one, alpha)), through), d,
              tile.through + i);
    hn::Store(hn::IfThenElse(which, hn::Set(d, kClosed), hn::Load(d, tile.far_m + i)), d,
              tile.far_m + i);
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
  /// about an edge leaves the light of a half of it, { l : n l < at }; n is the way from the mean l
  /// of what it covers to the lens's centre, and how far off that mean lies, of what it would if
  /// the edge were straight, tells how much of the layer is such a half and how much covers evenly.
  /// A splat further behind counts by where on the lens it is seen. One side is kept a sample, the
  /// one of the most contrast.
  HWY_INLINE void findSide(std::size_t i, M which, const Covering& layer, V alpha) {
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
    M better = hn::And(which, hn::Gt(contrast, hn::Load(d, tile.contrast + i)));
    better = hn::And(better, hn::And(hn::Gt(covering, hn::Set(d, kPartial)),
                                     hn::Lt(alpha, hn::Set(d, 1.0f - kPartial))));
    if (hn::AllFalse(d, better)) return;
    any_side = true;
    const V inv_length = hn::Div(one, hn::Max(length, tiny));
    const auto keep = [&](float* to, V value) {
      hn::Store(hn::IfThenElse(better, value, hn::Load(d, to + i)), d, to + i);
    };
    keep(tile.side_x, hn::Mul(mx, inv_length));
    keep(tile.side_y, hn::Mul(my, inv_length));
    keep(tile.side_at, at);
    keep(tile.outside, outside);
    keep(tile.contrast, contrast);
  }

  /// Notes where the light that one layer covers in part falls on another, and where one layer
  /// holds more than a surface. What a lens sees there hangs on where it covers.
  HWY_INLINE void lookForOverlap(std::size_t i, M which, V weight, V through) {
    const D d;
    const V one = hn::Set(d, 1.0f), partial = hn::Load(d, tile.partial + i);
    const V covered = hn::Min(weight, one);
    const V least = hn::Set(d, kPartial);
    M found = hn::Gt(hn::Mul(covered, partial), least);
    found = hn::Or(found, hn::And(hn::Gt(weight, hn::Set(d, kTooMuch)), hn::Gt(through, least)));
    overlap |= !hn::AllFalse(d, hn::And(which, found));
    const V here = hn::Mul(through, hn::Min(covered, hn::Sub(one, covered)));
    hn::Store(hn::IfThenElse(which, hn::Max(partial, here), partial), d, tile.partial + i);
  }

  HWY_INLINE void closeAll() {
    const D d;
    for (std::size_t i = 0; i < kSamples; i += hn::Lanes(d))
      closeLayers(i, hn::FirstN(d, hn::Lanes(d)));
    any_from_behind = false;
  }

  /// The most light that passes anywhere.
  HWY_INLINE float mostThrough() const {
    return *std::max_element(tile.through, tile.through + kSamples);
  }

  /// Adds one splat, moved by `shift`; returns the number of samples in its footprint.
  template <bool kSides>
  HWY_INLINE std::size_t add(const Splat& splat, const SplatLens& lens, const TileJob& job,
                             const glm::vec2& shift) {
    const D d;
    const float left = (splat.x_px + shift.x - job.x) * job.per_step;
    const float top = (splat.y_px + shift.y - job.y) * job.per_step;
    const float extent_x = splat.extent_x_px * job.per_step;
    const float extent_y = splat.extent_y_px * job.per_step;
    if (left + extent_x < 0.0f || left - extent_x > kSide - 1.0f || top + extent_y < 0.0f ||
        top - extent_y > kSide - 1.0f) {
      return 0;
    }
    const float step2 = 1.0f / (job.per_step * job.per_step);
    const auto block = [](float sample) {
      return static_cast<unsigned>(std::clamp(sample, 0.0f, kSide - 1.0f)) / kBlock;
    };
    const unsigned x0 = block(left - extent_x), x1 = block(left + extent_x);
    const unsigned y0 = block(top - extent_y), y1 = block(top + extent_y);
    const unsigned columns = x1 - x0 + 1, blocks = columns * (y1 - y0 + 1);
    const V cx = hn::Set(d, left), cy = hn::Set(d, top);
    const V qa = hn::Set(d, splat.qa * step2), qb = hn::Set(d, splat.qb * step2);
    const V qc = hn::Set(d, splat.qc * step2);
    const V k0 = hn::Set(d, splat.k0), k1 = hn::Set(d, splat.k1), k2 = hn::Set(d, splat.k2);
    const V red = hn::Set(d, splat.red), green = hn::Set(d, splat.green);
    const V blue = hn::Set(d, splat.blue), opacity = hn::Set(d, std::abs(splat.opacity));
    const bool from_behind = splat.opacity < 0.0f;
    any_from_behind |= from_behind;
    Sums& sums = from_behind ? tile.from_behind : tile.facing;
    const V near_m = hn::Set(d, splat.near_m), far_m = hn::Set(d, splat.far_m);
    const V distance = hn::Mul(hn::Mul(hn::Set(d, 0.5f), hn::Add(near_m, far_m)), opacity);
    const V one = hn::Set(d, 1.0f);
    const V per_x = hn::Set(d, lens.per_px * job.lens_x / job.per_step);
    const V per_y = hn::Set(d, lens.per_px * job.lens_y / job.per_step);
    const V inv_width = hn::Set(d, lens.inv_width);

    std::size_t fragments = 0;
    // One flat loop over the blocks that the box may touch: two nested short ones mispredict.
    unsigned first = (y0 * kBlocks + x0) * kBlockSamples, column = 0;
    for (unsigned b = 0; b < blocks; ++b) {
      for (std::size_t part = 0; part < kBlockSamples; part += hn::Lanes(d)) {
        const std::size_t i = first + part;
        const V dx = hn::Sub(hn::Load(d, kPlaces<kSide>.x + i), cx);
        const V dy = hn::Sub(hn::Load(d, kPlaces<kSide>.y + i), cy);
        const V slope = hn::MulAdd(qa, dx, hn::Mul(qb, dy));
        const V t = hn::NegMulAdd(slope, dx, hn::NegMulAdd(hn::Mul(qc, dy), dy, one));
        const M inside = hn::Gt(t, hn::Zero(d));
        fragments += hn::CountTrue(d, inside);

        const V open = hn::Load(d, tile.far_m + i);
        const M behind = hn::And(inside, hn::Gt(near_m, open));
        if (HWY_UNLIKELY(!hn::AllFalse(d, behind))) closeLayers(i, behind);

        V w = hn::IfThenElseZero(inside, hn::MulAdd(hn::MulAdd(k2, t, k1), t, k0));
        const V before = hn::Load(d, sums.weight + i);
        if constexpr (kLens) {
          // A surface's kernels sum to one: what comes once they have lies behind it.
          const V room = hn::MulAdd(before, hn::Set(d, -kCloses), hn::Set(d, 1.0f + kCloses));
          w = hn::Mul(w, hn::Min(hn::Max(room, hn::Zero(d)), one));
        }
        V seen = w;
        if constexpr (kLens) {
          const V lx = hn::Mul(dx, per_x), ly = hn::Mul(dy, per_y);
          hn::Store(hn::MulAdd(w, lx, hn::Load(d, sums.lens_x + i)), d, sums.lens_x + i);
          hn::Store(hn::MulAdd(w, ly, hn::Load(d, sums.lens_y + i)), d, sums.lens_y + i);
          if constexpr (kSides) {
            const V off = hn::NegMulAdd(
                hn::Load(d, tile.side_x + i), lx,
                hn::NegMulAdd(hn::Load(d, tile.side_y + i), ly, hn::Load(d, tile.side_at + i)));
            const V within =
                hn::Min(hn::Max(hn::MulAdd(off, inv_width, hn::Set(d, 0.5f)), hn::Zero(d)), one);
            seen = hn::Mul(w, hn::MulAdd(hn::Load(d, tile.contrast + i), within,
                                         hn::Load(d, tile.outside + i)));
          }
        }
        const auto accumulate = [&](float* sum, V value) {
          hn::Store(hn::MulAdd(seen, value, hn::Load(d, sum + i)), d, sum + i);
        };
        hn::Store(hn::Add(w, before), d, sums.weight + i);
        accumulate(sums.red, red);
        accumulate(sums.green, green);
        accumulate(sums.blue, blue);
        if constexpr (kTransparent || kLens) accumulate(sums.visible, opacity);
        if constexpr (kDepth) accumulate(sums.distance, distance);
        hn::Store(hn::IfThenElse(inside, hn::Max(open, far_m), open), d, tile.far_m + i);
      }
      const bool row_ends = ++column == columns;
      first += row_ends ? (kBlocks - columns + 1) * kBlockSamples : kBlockSamples;
      column = row_ends ? 0 : column;
    }
    return fragments;
  }

  /// Composites all splats as seen through a part of the lens, from its centre or shifted.
  template <class ShiftOf>
  HWY_INLINE std::size_t compose(const TileJob& job, const Splat* splats, const SplatLens* lenses,
                                 const ShiftOf& shiftOf) {
    std::fill_n(tile.through, kSamples, 1.0f);
    if (any_side) {
      std::fill_n(tile.side_x, 5 * kSamples, 0.0f);
      any_side = false;
    }
    if constexpr (kLens) std::fill_n(tile.outside, kSamples, 1.0f);
    std::fill_n(tile.out_red, 5 * kSamples, 0.0f);
    std::size_t fragments = 0;
    float open_far_m = job.count > 0 ? splats[job.entries[0]].far_m : 0.0f;
    for (std::size_t e = 0; e < job.count; ++e) {
      constexpr std::size_t kAhead = 8;
      if (e + kAhead < job.count) hwy::Prefetch(&splats[job.entries[e + kAhead]]);
      const Splat& splat = splats[job.entries[e]];

      // A gap in depth across the whole tile closes every layer; with no light left, the tile is
      // done.
      if (HWY_UNLIKELY(splat.near_m > open_far_m)) {
        closeAll();
        if (mostThrough() < kHidden) break;
      }
      open_far_m = std::max(open_far_m, splat.far_m);
      const SplatLens lens = kLens ? lenses[job.entries[e]] : SplatLens{};
      const glm::vec2 shift = shiftOf(job.entries[e]);
      fragments += kLens && any_side ? add<true>(splat, lens, job, shift)
                                     : add<false>(splat, lens, job, shift);
    }
    closeAll();
    return fragments;
  }

  /// Adds a share of what is composited to the result.
  void emit(const TileJob& job, float share) const {
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        const int i = ((y / kBlock) * kBlocks + x / kBlock) * kBlockSamples +
                      (y % kBlock) * kBlock + x % kBlock;
        const float through = tile.through[i];
        job.rgba[y * kSide + x] +=
            share * glm::vec4(tile.out_red[i] + through * job.background[0],
                              tile.out_green[i] + through * job.background[1],
                              tile.out_blue[i] + through * job.background[2], 1.0f - through);
        if (kDepth) job.depth_m[y * kSide + x] += share * tile.out_distance[i];
      }
    }
  }

  std::size_t run(const TileJob& job) {
    std::fill_n(tile.facing.weight, sizeof(tile) / sizeof(float), 0.0f);
    std::fill_n(tile.far_m, kSamples, kClosed);
    std::fill_n(job.rgba, kSamples, glm::vec4(0.0f));
    if (kDepth) std::fill_n(job.depth_m, kSamples, 0.0f);

    const LensParts* parts = job.parts;
    std::size_t fragments = 0;
    fragments += compose(job, job.splats, job.lens, [](std::uint32_t) { return glm::vec2(0.0f); });
    if (!parts || !overlap) {
      emit(job, 1.0f);
      return fragments;
    }
    for (const glm::vec2& centre : parts->centres) {
      const glm::vec2 px_per_D = job.radius_px_per_D * centre;
      fragments += compose(job, parts->splats, parts->lens, [&](std::uint32_t splat) {
        return px_per_D * parts->out_of_focus_D[splat];
      });
      emit(job, 1.0f / static_cast<float>(parts->centres.size()));
    }
    return fragments;
  }

  static constexpr float kClosed = -1.0f;  // before any z-range
};

template <int kSide>
std::size_t sweepTile(const TileJob& job, bool transparent) {
  const auto run = [&]<bool kTransparent, bool kDepth>() {
    if (job.lens) {
      Sweep<kSide, kTransparent, kDepth, true> sweep;
      return sweep.run(job);
    }
    Sweep<kSide, kTransparent, kDepth, false> sweep;
    return sweep.run(job);
  };
  if (job.depth_m)
    return transparent ? run.template operator()<true, true>()
                       : run.template operator()<false, true>();
  return transparent ? run.template operator()<true, false>()
                     : run.template operator()<false, false>();
}

std::size_t sweepFine(const TileJob& job, bool transparent) {
  return sweepTile<kTile>(job, transparent);
}

std::size_t sweepCoarse(const TileJob& job, bool transparent) {
  return sweepTile<kTile + 2 * kApron>(job, transparent);
}

}  // namespace HWY_NAMESPACE
}  // namespace foci
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace foci {

HWY_EXPORT(sweepFine);
HWY_EXPORT(sweepCoarse);

std::uint64_t sweep(const SplatChunks& chunks, const TileLists& lists,
                    const SweepSettings& settings, Frame& frame) {
  std::vector<std::size_t> fragments(lists.tiles().size());
  parallelFor(lists.tiles().size(), [&](std::size_t t) {
    const Tile& tile = lists.tiles()[t];
    const auto list = lists.splats(t);
    constexpr int kWide = kTile + 2 * kApron;
    alignas(64) glm::vec4 rgba[kWide * kWide];
    float depth_m[kWide * kWide];
    const bool coarse = tile.step_px > 1;
    const auto step_px = static_cast<float>(tile.step_px);
    const float first_px = step_px * (0.5f - (coarse ? kApron : 0));
    const glm::vec2 radius = settings.radius_px_per_D;
    const float oblong = radius.x > 0.0f && radius.y > 0.0f ? std::sqrt(radius.y / radius.x) : 1.0f;
    const TileJob job{
        .splats = chunks.splats.get(),
        .entries = list.data(),
        .count = list.size(),
        .x = static_cast<float>(tile.x_px) + first_px,
        .y = static_cast<float>(tile.y_px) + first_px,
        .lens_x = oblong,
        .lens_y = 1.0f / oblong,
        .per_step = 1.0f / step_px,
        .background = {settings.background.r, settings.background.g, settings.background.b},
        .lens = tile.blur_px > kBlurred_px ? chunks.lens.get() : nullptr,
        .radius_px_per_D = radius,
        .parts = tile.blur_px > kPartsFrom_px ? settings.parts : nullptr,
        .rgba = rgba,
        .depth_m = settings.depth ? depth_m : nullptr};
    if (coarse) {
      fragments[t] = HWY_DYNAMIC_DISPATCH(sweepCoarse)(job, settings.transparent);
    } else {
      fragments[t] = HWY_DYNAMIC_DISPATCH(sweepFine)(job, settings.transparent);
    }
    interpolateTile(tile, rgba, job.depth_m, frame);
  });
  return std::accumulate(fragments.begin(), fragments.end(), std::uint64_t{0});
}

const char* simdTarget() {
  // Better targets have lower bits.
  const std::int64_t targets = hwy::SupportedTargets() & HWY_TARGETS;
  return hwy::TargetName(targets & -targets);
}

}  // namespace foci
#endif  // HWY_ONCE
