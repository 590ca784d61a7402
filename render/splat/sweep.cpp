#include "render/splat/sweep.h"

#include <hwy/cache_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
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

// A tile is 4 x 4 blocks of 4 x 4 pixels; a block's 16 pixels are consecutive, row by row.
constexpr int kBlock = 4, kBlocks = kTile_px / kBlock, kBlockPixels = kBlock * kBlock;
constexpr int kPixels = kTile_px * kTile_px;
static_assert(kBlock == 4 && kTile_px == 16);

/// Per pixel: the open layer's sums, and what is already composited.
struct Tile {
  alignas(64) float weight[kPixels], red[kPixels], green[kPixels], blue[kPixels], far_m[kPixels];
  alignas(64) float opacity[kPixels], distance[kPixels];  // sums, used where asked for
  alignas(64) float through[kPixels];                     // light that still passes
  alignas(64) float out_red[kPixels], out_green[kPixels], out_blue[kPixels], out_distance[kPixels];
};

template <bool kTransparent, bool kDepth>
struct Sweep {
  Tile tile;

  /// Composites the open layers of the pixels `i + lane` in `which` and opens new ones.
  HWY_INLINE void closeLayers(std::size_t i, M which) {
    const D d;
    const V one = hn::Set(d, 1.0f);
    const V weight = hn::Load(d, tile.weight + i);
    // alpha = min(1, W) A / W, with A = W for opaque splats; colours scale alike.
    const V scale = hn::Div(one, hn::Max(weight, one));
    const V alpha =
        kTransparent ? hn::Mul(scale, hn::Load(d, tile.opacity + i)) : hn::Mul(scale, weight);
    const V through = hn::Load(d, tile.through + i);
    const V passed = hn::IfThenElseZero(which, hn::Mul(through, scale));
    const auto compose = [&](float* out, float* sum) {
      const V value = hn::Load(d, sum + i);
      hn::Store(hn::MulAdd(passed, value, hn::Load(d, out + i)), d, out + i);
      hn::Store(hn::IfThenZeroElse(which, value), d, sum + i);
    };
    compose(tile.out_red, tile.red);
    compose(tile.out_green, tile.green);
    compose(tile.out_blue, tile.blue);
    if constexpr (kDepth) compose(tile.out_distance, tile.distance);
    if constexpr (kTransparent) {
      hn::Store(hn::IfThenZeroElse(which, hn::Load(d, tile.opacity + i)), d, tile.opacity + i);
    }
    hn::Store(hn::IfThenElse(which, hn::Mul(through, hn::Sub(one, alpha)), through), d,
              tile.through + i);
    hn::Store(hn::IfThenZeroElse(which, weight), d, tile.weight + i);
    hn::Store(hn::IfThenElse(which, hn::Set(d, kClosed), hn::Load(d, tile.far_m + i)), d,
              tile.far_m + i);
  }

  HWY_INLINE void closeAll() {
    const D d;
    for (std::size_t i = 0; i < kPixels; i += hn::Lanes(d))
      closeLayers(i, hn::FirstN(d, hn::Lanes(d)));
  }

  /// The most light that passes any pixel.
  HWY_INLINE float mostThrough() const {
    return *std::max_element(tile.through, tile.through + kPixels);
  }

  /// Adds one splat to the pixels of its footprint; returns how many they are.
  HWY_INLINE std::size_t add(const Splat& splat, float tile_x_px, float tile_y_px) {
    const D d;
    const std::size_t n = hn::Lanes(d);

    // Blocks that the footprint's box reaches.
    const float left = splat.x_px - tile_x_px - 0.5f, top = splat.y_px - tile_y_px - 0.5f;
    const auto block = [](float pixel) {
      return static_cast<int>(std::clamp(pixel, 0.0f, kTile_px - 1.0f)) / kBlock;
    };
    const int bx0 = block(left - splat.extent_x_px), bx1 = block(left + splat.extent_x_px);
    const int by0 = block(top - splat.extent_y_px), by1 = block(top + splat.extent_y_px);

    // t = 1 - q over a block is a quadratic in the lane's place (lx, ly), whose own part is the
    // same for every block.
    const V qa = hn::Set(d, splat.qa), qb = hn::Set(d, splat.qb), qc = hn::Set(d, splat.qc);
    const V k0 = hn::Set(d, splat.k0), k1 = hn::Set(d, splat.k1), k2 = hn::Set(d, splat.k2);
    const V near_m = hn::Set(d, splat.near_m), far_m = hn::Set(d, splat.far_m);
    std::size_t fragments = 0;
    for (std::size_t part = 0; part < kBlockPixels; part += n) {
      const V lane = hn::Iota(d, static_cast<float>(part));
      const V ly = hn::Floor(hn::Mul(lane, hn::Set(d, 1.0f / kBlock)));
      const V lx = hn::NegMulAdd(ly, hn::Set(d, static_cast<float>(kBlock)), lane);
      const V own =
          hn::MulAdd(hn::MulAdd(qa, lx, hn::Mul(qb, ly)), lx, hn::Mul(hn::Mul(qc, ly), ly));
      for (int by = by0; by <= by1; ++by) {
        const float oy = static_cast<float>(kBlock * by) - top;
        for (int bx = bx0; bx <= bx1; ++bx) {
          const float ox = static_cast<float>(kBlock * bx) - left;
          const float base = 1.0f - (splat.qa * ox + splat.qb * oy) * ox - splat.qc * oy * oy;
          const V gx = hn::Set(d, 2.0f * splat.qa * ox + splat.qb * oy);
          const V gy = hn::Set(d, splat.qb * ox + 2.0f * splat.qc * oy);
          const V t = hn::NegMulAdd(gx, lx, hn::NegMulAdd(gy, ly, hn::Sub(hn::Set(d, base), own)));
          const M inside = hn::Gt(t, hn::Zero(d));
          const std::size_t covered = hn::CountTrue(d, inside);
          if (covered == 0) continue;
          fragments += covered;

          const std::size_t i = static_cast<std::size_t>((by * kBlocks + bx) * kBlockPixels) + part;
          const M behind = hn::And(inside, hn::Gt(near_m, hn::Load(d, tile.far_m + i)));
          if (!hn::AllFalse(d, behind)) closeLayers(i, behind);

          const V w = hn::IfThenElseZero(inside, hn::MulAdd(hn::MulAdd(k2, t, k1), t, k0));
          const auto accumulate = [&](float* sum, float value) {
            hn::Store(hn::MulAdd(w, hn::Set(d, value), hn::Load(d, sum + i)), d, sum + i);
          };
          hn::Store(hn::Add(w, hn::Load(d, tile.weight + i)), d, tile.weight + i);
          accumulate(tile.red, splat.red);
          accumulate(tile.green, splat.green);
          accumulate(tile.blue, splat.blue);
          if constexpr (kTransparent) accumulate(tile.opacity, splat.opacity);
          if constexpr (kDepth) {
            accumulate(tile.distance, 0.5f * (splat.near_m + splat.far_m) * splat.opacity);
          }
          const V open = hn::Load(d, tile.far_m + i);
          hn::Store(hn::IfThenElse(inside, hn::Max(open, far_m), open), d, tile.far_m + i);
        }
      }
    }
    return fragments;
  }

  std::size_t run(const TileJob& job) {
    std::fill_n(tile.weight, sizeof(Tile) / sizeof(float), 0.0f);
    std::fill_n(tile.far_m, kPixels, kClosed);
    std::fill_n(tile.through, kPixels, 1.0f);

    std::size_t fragments = 0;
    float open_far_m = std::numeric_limits<float>::infinity();
    for (std::size_t e = 0; e < job.count; ++e) {
      constexpr std::size_t kAhead = 8;
      if (e + kAhead < job.count) hwy::Prefetch(&job.splats[job.entries[e + kAhead]]);
      const Splat& splat = job.splats[job.entries[e]];

      // A gap across the whole tile closes every layer; with no light left, the tile is done.
      if (splat.near_m > open_far_m) {
        closeAll();
        if (mostThrough() < kHidden) break;
        open_far_m = splat.far_m;
      }
      open_far_m = e == 0 ? splat.far_m : std::max(open_far_m, splat.far_m);
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
  tbb::parallel_for(std::size_t{0}, tile_count, [&](std::size_t t) {
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

}  // namespace foci
#endif  // HWY_ONCE
