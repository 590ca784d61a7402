#include "render/splat/sweep.h"

#include <hwy/cache_control.h>
#include "app/base/parallel.h"

#include <algorithm>
#include <cmath>
#include <numeric>

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

struct TileJob {
  const Splat* splats;
  const std::uint32_t* entries;
  std::size_t count;
  int x_px, y_px;           // the tile's corner
  int width_px, height_px;  // what of it lies on the image
  float background[3];
  glm::vec4* rgba;  // the tile's corner in the frame
  float* depth_m;   // likewise; null: not asked for
  std::size_t stride;
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

// A tile is blocks of 4 x 4 pixels; a block's 16 pixels are consecutive, row by row.
constexpr int kBlock = 4, kBlocks = kTile_px / kBlock, kBlockPixels = kBlock * kBlock;
constexpr int kPixels = kTile_px * kTile_px;
static_assert(kBlock == 4);

/// Per pixel, sums over the splats of an open layer. `opacity` and `distance` are used where asked
/// for.
struct Sums {
  alignas(64) float weight[kPixels], red[kPixels], green[kPixels], blue[kPixels];
  alignas(64) float opacity[kPixels], distance[kPixels];
};

/// Per pixel: the open layer and what is already composited.
struct Tile {
  Sums facing, from_behind;            // the layer's surfaces by the side that is seen
  alignas(64) float far_m[kPixels];    // where its z-range ends
  alignas(64) float through[kPixels];  // light that still passes
  alignas(64) float out_red[kPixels], out_green[kPixels], out_blue[kPixels], out_distance[kPixels];
};

/// Where the pixel centres of a tile lie, from the first, in the order of `Tile`.
struct Places {
  alignas(64) float x[kPixels], y[kPixels];
  constexpr Places() : x(), y() {
    for (int i = 0; i < kPixels; ++i) {
      const int block = i / kBlockPixels, pixel = i % kBlockPixels;
      const int column = block % kBlocks * kBlock + pixel % kBlock;
      const int row = block / kBlocks * kBlock + pixel / kBlock;
      x[i] = static_cast<float>(column);
      y[i] = static_cast<float>(row);
    }
  }
};
constexpr Places kPlaces;

template <bool kTransparent, bool kDepth>
struct Sweep {
  Tile tile;
  bool any_from_behind = false;  // in the open layers

  /// Composites the open layers of the pixels `i + lane` in `which` and opens new ones.
  HWY_INLINE void closeLayers(std::size_t i, M which) {
    const D d;
    const V one = hn::Set(d, 1.0f);
    const V through = hn::Load(d, tile.through + i);
    V alpha = hn::Zero(d);

    // A side covers min(1, W) of the pixel; `share` of that counts. Colours and opacities, which
    // are sums over W, scale alike.
    const auto composeSide = [&](Sums& sums, V weight, V share) {
      const V scale = hn::Div(share, hn::Max(weight, one));
      const V passed = hn::IfThenElseZero(which, hn::Mul(through, scale));
      const auto compose = [&](float* out, float* sum) {
        const V value = hn::Load(d, sum + i);
        hn::Store(hn::MulAdd(passed, value, hn::Load(d, out + i)), d, out + i);
        hn::Store(hn::IfThenZeroElse(which, value), d, sum + i);
      };
      compose(tile.out_red, sums.red);
      compose(tile.out_green, sums.green);
      compose(tile.out_blue, sums.blue);
      if constexpr (kDepth) compose(tile.out_distance, sums.distance);
      V opaque = weight;
      if constexpr (kTransparent) {
        opaque = hn::Load(d, sums.opacity + i);
        hn::Store(hn::IfThenZeroElse(which, opaque), d, sums.opacity + i);
      }
      alpha = hn::MulAdd(scale, opaque, alpha);
      hn::Store(hn::IfThenZeroElse(which, weight), d, sums.weight + i);
    };

    const V facing = hn::Load(d, tile.facing.weight + i);
    composeSide(tile.facing, facing, one);
    if (any_from_behind) {
      // The far side of a solid meets the near side at its outline, at one distance and within one
      // layer, but no ray sees both: it counts where it covers more than the near side does.
      const V behind = hn::Load(d, tile.from_behind.weight + i);
      const V covered = hn::Min(behind, one);
      const V left = hn::Max(hn::Sub(covered, hn::Min(facing, one)), hn::Zero(d));
      composeSide(tile.from_behind, behind, hn::Div(left, hn::Max(covered, hn::Set(d, 1e-20f))));
    }
    hn::Store(hn::IfThenElse(which, hn::Mul(through, hn::Sub(one, alpha)), through), d,
              tile.through + i);
    hn::Store(hn::IfThenElse(which, hn::Set(d, kClosed), hn::Load(d, tile.far_m + i)), d,
              tile.far_m + i);
  }

  HWY_INLINE void closeAll() {
    const D d;
    for (std::size_t i = 0; i < kPixels; i += hn::Lanes(d))
      closeLayers(i, hn::FirstN(d, hn::Lanes(d)));
    any_from_behind = false;
  }

  /// The most light that passes any pixel.
  HWY_INLINE float mostThrough() const {
    return *std::max_element(tile.through, tile.through + kPixels);
  }

  /// Adds one splat; returns the number of pixels in its footprint.
  HWY_INLINE std::size_t add(const Splat& splat, float tile_x_px, float tile_y_px) {
    const D d;
    const float left = splat.x_px - tile_x_px - 0.5f, top = splat.y_px - tile_y_px - 0.5f;
    const auto block = [](float pixel) {
      return static_cast<unsigned>(std::clamp(pixel, 0.0f, kTile_px - 1.0f)) / kBlock;
    };
    const unsigned x0 = block(left - splat.extent_x_px), x1 = block(left + splat.extent_x_px);
    const unsigned y0 = block(top - splat.extent_y_px), y1 = block(top + splat.extent_y_px);
    const unsigned columns = x1 - x0 + 1, blocks = columns * (y1 - y0 + 1);
    const V cx = hn::Set(d, left), cy = hn::Set(d, top);
    const V qa = hn::Set(d, splat.qa), qb = hn::Set(d, splat.qb), qc = hn::Set(d, splat.qc);
    const V k0 = hn::Set(d, splat.k0), k1 = hn::Set(d, splat.k1), k2 = hn::Set(d, splat.k2);
    const V red = hn::Set(d, splat.red), green = hn::Set(d, splat.green);
    const V blue = hn::Set(d, splat.blue), opacity = hn::Set(d, std::abs(splat.opacity));
    const bool from_behind = splat.opacity < 0.0f;
    any_from_behind |= from_behind;
    Sums& sums = from_behind ? tile.from_behind : tile.facing;
    const V near_m = hn::Set(d, splat.near_m), far_m = hn::Set(d, splat.far_m);
    const V distance = hn::Mul(hn::Mul(hn::Set(d, 0.5f), hn::Add(near_m, far_m)), opacity);
    const V one = hn::Set(d, 1.0f);

    std::size_t fragments = 0;
    // One flat loop over the blocks that the box may touch: two nested short ones mispredict.
    unsigned first = (y0 * kBlocks + x0) * kBlockPixels, column = 0;
    for (unsigned b = 0; b < blocks; ++b) {
      for (std::size_t part = 0; part < kBlockPixels; part += hn::Lanes(d)) {
        const std::size_t i = first + part;
        const V dx = hn::Sub(hn::Load(d, kPlaces.x + i), cx);
        const V dy = hn::Sub(hn::Load(d, kPlaces.y + i), cy);
        const V slope = hn::MulAdd(qa, dx, hn::Mul(qb, dy));
        const V t = hn::NegMulAdd(slope, dx, hn::NegMulAdd(hn::Mul(qc, dy), dy, one));
        const M inside = hn::Gt(t, hn::Zero(d));
        fragments += hn::CountTrue(d, inside);

        const V open = hn::Load(d, tile.far_m + i);
        const M behind = hn::And(inside, hn::Gt(near_m, open));
        if (HWY_UNLIKELY(!hn::AllFalse(d, behind))) closeLayers(i, behind);

        const V w = hn::IfThenElseZero(inside, hn::MulAdd(hn::MulAdd(k2, t, k1), t, k0));
        const auto accumulate = [&](float* sum, V value) {
          hn::Store(hn::MulAdd(w, value, hn::Load(d, sum + i)), d, sum + i);
        };
        hn::Store(hn::Add(w, hn::Load(d, sums.weight + i)), d, sums.weight + i);
        accumulate(sums.red, red);
        accumulate(sums.green, green);
        accumulate(sums.blue, blue);
        if constexpr (kTransparent) accumulate(sums.opacity, opacity);
        if constexpr (kDepth) accumulate(sums.distance, distance);
        hn::Store(hn::IfThenElse(inside, hn::Max(open, far_m), open), d, tile.far_m + i);
      }
      const bool row_ends = ++column == columns;
      first += row_ends ? (kBlocks - columns + 1) * kBlockPixels : kBlockPixels;
      column = row_ends ? 0 : column;
    }
    return fragments;
  }

  std::size_t run(const TileJob& job) {
    std::fill_n(tile.facing.weight, sizeof(Tile) / sizeof(float), 0.0f);
    std::fill_n(tile.far_m, kPixels, kClosed);
    std::fill_n(tile.through, kPixels, 1.0f);

    std::size_t fragments = 0;
    float open_far_m = job.count > 0 ? job.splats[job.entries[0]].far_m : 0.0f;
    for (std::size_t e = 0; e < job.count; ++e) {
      constexpr std::size_t kAhead = 8;
      if (e + kAhead < job.count) hwy::Prefetch(&job.splats[job.entries[e + kAhead]]);
      const Splat& splat = job.splats[job.entries[e]];

      // A gap in depth across the whole tile closes every layer; with no light left, the tile is
      // done.
      if (HWY_UNLIKELY(splat.near_m > open_far_m)) {
        closeAll();
        if (mostThrough() < kHidden) break;
      }
      open_far_m = std::max(open_far_m, splat.far_m);
      fragments += add(splat, static_cast<float>(job.x_px), static_cast<float>(job.y_px));
    }
    closeAll();

    for (int y = 0; y < job.height_px; ++y) {
      for (int x = 0; x < job.width_px; ++x) {
        const int i = ((y / kBlock) * kBlocks + x / kBlock) * kBlockPixels + (y % kBlock) * kBlock +
                      x % kBlock;
        const float through = tile.through[i];
        job.rgba[static_cast<std::size_t>(y) * job.stride + x] = {
            tile.out_red[i] + through * job.background[0],
            tile.out_green[i] + through * job.background[1],
            tile.out_blue[i] + through * job.background[2], 1.0f - through};
        if (kDepth) {
          job.depth_m[static_cast<std::size_t>(y) * job.stride + x] =
              through < 1.0f ? tile.out_distance[i] / (1.0f - through) : 0.0f;
        }
      }
    }
    return fragments;
  }

  static constexpr float kClosed = -1.0f;  // before any z-range
};

std::size_t sweepTile(const TileJob& job, bool transparent) {
  const auto run = [&]<bool kTransparent, bool kDepth>() {
    Sweep<kTransparent, kDepth> sweep;
    return sweep.run(job);
  };
  if (job.depth_m)
    return transparent ? run.template operator()<true, true>()
                       : run.template operator()<false, true>();
  return transparent ? run.template operator()<true, false>()
                     : run.template operator()<false, false>();
}

}  // namespace HWY_NAMESPACE
}  // namespace foci
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace foci {

HWY_EXPORT(sweepTile);

std::uint64_t sweep(const SplatChunks& chunks, const TileLists& lists, const glm::vec3& background,
                    bool transparent, bool depth, Frame& frame) {
  const glm::ivec2 tiles = lists.tiles();
  const auto tile_count = static_cast<std::size_t>(tiles.x) * tiles.y;
  std::vector<std::size_t> fragments(tile_count);
  parallelFor(tile_count, [&](std::size_t t) {
    const auto list = lists.tile(static_cast<int>(t));
    const int x_px = static_cast<int>(t % tiles.x) * kTile_px;
    const int y_px = static_cast<int>(t / tiles.x) * kTile_px;
    const std::size_t corner = static_cast<std::size_t>(y_px) * frame.size_px.x + x_px;
    fragments[t] =
        HWY_DYNAMIC_DISPATCH(sweepTile)({.splats = chunks.splats.get(),
                                         .entries = list.data(),
                                         .count = list.size(),
                                         .x_px = x_px,
                                         .y_px = y_px,
                                         .width_px = std::min(kTile_px, frame.size_px.x - x_px),
                                         .height_px = std::min(kTile_px, frame.size_px.y - y_px),
                                         .background = {background.r, background.g, background.b},
                                         .rgba = frame.rgba.data() + corner,
                                         .depth_m = depth ? frame.depth_m.data() + corner : nullptr,
                                         .stride = static_cast<std::size_t>(frame.size_px.x)},
                                        transparent);
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
