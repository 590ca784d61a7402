// Draws the splats of one tile: through the lens as a whole, and by parts of it where layers cover
// each other. Included once a SIMD target.
#if defined(FOCI_SWEEP_TILE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FOCI_SWEEP_TILE_INL_H
#undef FOCI_SWEEP_TILE_INL_H
#else
#define FOCI_SWEEP_TILE_INL_H
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>

#include "render/kernel/limits.h"
#include "render/splat/batch-inl.h"
#include "render/splat/layers-inl.h"
#include "render/splat/part_splats-inl.h"
#include "render/splat/splat.h"
#include "render/splat/sweep.h"

#ifndef FOCI_SWEEP_TILE_ONCE
#define FOCI_SWEEP_TILE_ONCE
namespace foci {

/// Splats are fetched from memory this many before they are used.
inline constexpr std::size_t kAhead = 16;

/// A tile, and how it is rendered.
struct TileJob {
  const Splat* splats;
  const std::uint32_t* entries;
  std::size_t count;
  const std::uint8_t* gap;  // by entry: before it a gap in depth, across the whole tile
  int samples;              // along a side, with the apron
  float x, y;               // of the first sample, pixels
  float lens_x, lens_y;     // what a mean radius counts along the axes, where pixels are oblong
  glm::vec2 meridian;       // of an astigmatic lens the nearest
  float per_step;           // 1 / the distance of samples, pixels
  float background[3];
  const SplatLens* lens;         // null: nothing is blurred
  const SplatLens* lens_across;  // null: the lens is round
  glm::vec2 radius_px_per_D;
  const LensParts* parts;  // null: never by parts
  float parts_share;       // of the image, where it is rendered by them
  glm::vec4* rgba;         // samples x samples, all 0
  float* depth_m;          // likewise; null: not asked for
};

}  // namespace foci
#endif  // FOCI_SWEEP_TILE_ONCE

HWY_BEFORE_NAMESPACE();
namespace foci {
namespace HWY_NAMESPACE {
/// Where a block's samples lie, from its first.
struct Places {
  alignas(64) BlockValues x, y;
  constexpr Places() : x(), y() {
    for (int i = 0; i < kBlockSamples; ++i) {
      x[i] = static_cast<float>(i % kBlock);
      y[i] = static_cast<float>(i / kBlock);
    }
  }
};
constexpr Places kPlaces;

/// Through the lens as a whole what covers which part of it is noted: its points are in lens radii
/// along the image's axes; where the lens is astigmatic, along its nearest meridian and across it.
/// Parts of a lens are too small to be worth it.
enum class Blur { none, part, round, astigmatic };
constexpr bool asAWhole(Blur blur) { return blur == Blur::round || blur == Blur::astigmatic; }

/// Draws the splats of a tile.
template <bool kTransparent, bool kDepth, Blur kBlur>
struct Sweep : Layers<kTransparent, kDepth, asAWhole(kBlur)> {
  static constexpr bool kAstigmatic = kBlur == Blur::astigmatic;
  static constexpr bool kLens = asAWhole(kBlur);
  using Base = Layers<kTransparent, kDepth, kLens>;
  using Parts = Sweep<kTransparent, kDepth, Blur::part>;
  using Base::addBeyond, Base::any_from_behind, Base::blocks, Base::clear, Base::closeAll,
      Base::tile;
  using Base::closeLayers, Base::columns, Base::goesDark, Base::lit, Base::overlap;

  const TileJob& job;
  Batch batch;
  std::size_t fragments = 0;

  explicit Sweep(const TileJob& tile_job) : Base(tile_job.samples), job(tile_job) {}

  /// Adds the splats of the batch, block by block, and empties it.
  HWY_INLINE void flush(const Splat* splats) {
    if (batch.count == 0) return;
    const float inner_px = (kBlock - 1) / job.per_step, block_px = kBlock / job.per_step;
    std::uint64_t in_column[Base::kMaxBlocks];
    for (unsigned x = 0; x < columns; ++x) {
      const float from_px = job.x + block_px * static_cast<float>(x);
      in_column[x] = batch.meeting(batch.left_px, batch.right_px, from_px, from_px + inner_px);
    }
    for (unsigned y = 0; y < columns; ++y) {
      const float from_px = job.y + block_px * static_cast<float>(y);
      const std::uint64_t in_row =
          batch.meeting(batch.top_px, batch.bottom_px, from_px, from_px + inner_px);
      for (unsigned x = 0; x < columns; ++x) {
        const std::size_t index = y * columns + x;
        const Block& block = tile[index];
        const std::uint64_t touching = in_row & in_column[x];
        if (touching == 0 || block.dark) continue;
        for (std::size_t i = 0; i < kBlockSamples && !block.dark; i += hn::Lanes(D())) {
          add(splats, index, i, static_cast<float>(x * kBlock), static_cast<float>(y * kBlock),
              touching);
        }
      }
    }
    batch.count = 0;
  }

  /// Adds splats of the batch to a block's samples from `i` on, as many as there are lanes.
  HWY_NOINLINE void add(const Splat* splats, std::size_t index, std::size_t i, float at_x,
                        float at_y, std::uint64_t touching) {
    const D d;
    Block& block = tile[index];
    const V one = hn::Set(d, 1.0f), zero = hn::Zero(d), step = hn::Set(d, 1.0f / job.per_step);
    const V x =
        hn::MulAdd(hn::Add(hn::Load(d, kPlaces.x + i), hn::Set(d, at_x)), step, hn::Set(d, job.x));
    const V y =
        hn::MulAdd(hn::Add(hn::Load(d, kPlaces.y + i), hn::Set(d, at_y)), step, hn::Set(d, job.y));
    const Light& light = block.light;

    // The open layer, in registers: of one side at a time.
    Sums* sums = &block.facing;
    V open, weight, red, green, blue, visible = zero, distance = zero, lens_x = zero, lens_y = zero;
    const auto load = [&] {
      open = hn::Load(d, block.far_m + i);
      weight = hn::Load(d, sums->weight + i);
      red = hn::Load(d, sums->red + i);
      green = hn::Load(d, sums->green + i);
      blue = hn::Load(d, sums->blue + i);
      if constexpr (kTransparent || kLens) visible = hn::Load(d, sums->visible + i);
      if constexpr (kDepth) distance = hn::Load(d, sums->distance + i);
      if constexpr (kLens) {
        lens_x = hn::Load(d, sums->lens_x + i);
        lens_y = hn::Load(d, sums->lens_y + i);
      }
    };
    const auto store = [&] {
      hn::Store(open, d, block.far_m + i);
      hn::Store(weight, d, sums->weight + i);
      hn::Store(red, d, sums->red + i);
      hn::Store(green, d, sums->green + i);
      hn::Store(blue, d, sums->blue + i);
      if constexpr (kTransparent || kLens) hn::Store(visible, d, sums->visible + i);
      if constexpr (kDepth) hn::Store(distance, d, sums->distance + i);
      if constexpr (kLens) {
        hn::Store(lens_x, d, sums->lens_x + i);
        hn::Store(lens_y, d, sums->lens_y + i);
      }
    };
    load();

    for (; touching != 0; touching &= touching - 1) {
      const auto n = static_cast<unsigned>(std::countr_zero(touching));
      const Splat& splat = splats[batch.splat[n]];
      Sums* side = splat.opacity < 0.0f ? &block.from_behind : &block.facing;
      if (HWY_UNLIKELY(side != sums)) {
        store();
        sums = side;
        load();
      }
      const V dx = hn::Sub(x, hn::Set(d, batch.x_px[n])),
              dy = hn::Sub(y, hn::Set(d, batch.y_px[n]));
      const V slope = hn::MulAdd(hn::Set(d, splat.qa), dx, hn::Mul(hn::Set(d, splat.qb), dy));
      const V t =
          hn::NegMulAdd(slope, dx, hn::NegMulAdd(hn::Mul(hn::Set(d, splat.qc), dy), dy, one));
      const M inside = hn::Gt(t, zero);
      fragments += hn::CountTrue(d, inside);
      const V near_m = hn::Set(d, splat.near_m);
      const M behind = hn::And(inside, hn::And(hn::Gt(near_m, open), hn::Ge(open, zero)));
      if (HWY_UNLIKELY(!hn::AllFalse(d, behind))) {
        store();
        closeLayers(index, i, behind);
        if (goesDark(block)) return;
        load();
      }
      open = hn::IfThenElse(inside, hn::Max(open, hn::Set(d, splat.far_m)), open);
      V all = hn::IfThenElseZero(
          inside, hn::MulAdd(hn::MulAdd(hn::Set(d, splat.k2), t, hn::Set(d, splat.k1)), t,
                             hn::Set(d, splat.k0)));
      if constexpr (kBlur == Blur::part) all = hn::Mul(all, hn::Set(d, batch.size[n]));
      V passes = one;  // of the light, by where on the lens it falls
      V w;
      const auto fill = [&] {
        w = hn::Min(all, hn::Max(hn::Sub(hn::Set(d, kWhole), weight), zero));
      };
      if constexpr (kLens) {
        const SplatLens& lens = job.lens[batch.splat[n]];
        const SplatLens& across =
            kAstigmatic ? job.lens_across[batch.splat[n]] : job.lens[batch.splat[n]];
        const auto perPixel = [&](float x_of, float y_of) {
          return hn::MulAdd(dx, hn::Set(d, x_of), hn::Mul(dy, hn::Set(d, y_of)));
        };
        V lx, ly;
        if constexpr (kAstigmatic) {
          const glm::vec2 m = job.meridian * glm::vec2(job.lens_x, job.lens_y);
          const glm::vec2 a(-job.meridian.y * job.lens_x, job.meridian.x * job.lens_y);
          lx = perPixel(lens.per_px * m.x, lens.per_px * m.y);
          ly = perPixel(across.per_px * a.x, across.per_px * a.y);
        } else {
          lx = hn::Mul(dx, hn::Set(d, lens.per_px * job.lens_x));
          ly = hn::Mul(dy, hn::Set(d, lens.per_px * job.lens_y));
        }
        if (lens.tilt_x != 0.0f || lens.tilt_y != 0.0f) {
          const glm::vec2 tilt(lens.tilt_x, lens.tilt_y), m = job.meridian;
          const V tilt_x = hn::Set(d, kAstigmatic ? glm::dot(tilt, m) : tilt.x);
          const V tilt_y = hn::Set(d, kAstigmatic ? tilt.y * m.x - tilt.x * m.y : tilt.y);
          all = hn::Mul(all, hn::Abs(hn::MulAdd(tilt_x, lx, hn::MulAdd(tilt_y, ly, one))));
        }
        fill();
        lens_x = hn::MulAdd(w, lx, lens_x);
        lens_y = hn::MulAdd(w, ly, lens_y);
        if (block.any_side) passes = shareSeen(light, i, lx, ly, lens, across);
      } else {
        fill();
      }
      const V seen = hn::Mul(w, passes);
      if constexpr (kTransparent || kLens) {
        visible = hn::MulAdd(seen, hn::Set(d, std::abs(splat.opacity)), visible);
      }
      weight = hn::Add(weight, all);
      red = hn::MulAdd(seen, hn::Set(d, splat.red), red);
      green = hn::MulAdd(seen, hn::Set(d, splat.green), green);
      blue = hn::MulAdd(seen, hn::Set(d, splat.blue), blue);
      if constexpr (kDepth) {
        const float opaque_m = 0.5f * (splat.near_m + splat.far_m) * std::abs(splat.opacity);
        distance = hn::MulAdd(seen, hn::Set(d, opaque_m), distance);
      }
      if constexpr (kTransparent) {
        const V later = hn::Sub(all, w);
        if (side != &block.facing || hn::AllTrue(d, hn::Le(later, zero))) continue;
        addBeyond(index, i, hn::Mul(later, passes), splat);
        const M full = hn::Ge(weight, hn::Set(d, kWhole + 1.0f));
        if (HWY_LIKELY(hn::AllFalse(d, full))) continue;
        store();
        closeLayers(index, i, full);
        if (goesDark(block)) return;
        load();
      }
    }
    store();
  }

  /// Of what is seen from a lens point, with how far it spreads, the share that the layers before
  /// let through, over what they do on the mean.
  static HWY_INLINE V shareSeen(const Light& light, std::size_t i, V lx, V ly,
                                const SplatLens& lens, const SplatLens& across) {
    const D d;
    const V one = hn::Set(d, 1.0f);
    const V off = hn::NegMulAdd(
        hn::Load(d, light.side_x + i), lx,
        hn::NegMulAdd(hn::Load(d, light.side_y + i), ly, hn::Load(d, light.side_at + i)));
    V sharpness = hn::Set(d, lens.inv_width);
    if constexpr (kAstigmatic) {
      // The variance along the side's normal, whose parts' squares sum to 1.
      const V width2 = hn::Set(d, 1.0f / (lens.inv_width * lens.inv_width));
      const V across_width2 = hn::Set(d, 1.0f / (across.inv_width * across.inv_width));
      const V n = hn::Load(d, light.side_x + i);
      const V squared = hn::MulAdd(hn::Mul(n, n), hn::Sub(width2, across_width2), across_width2);
      sharpness = hn::Div(one, hn::Sqrt(squared));
    }
    const V within =
        hn::Min(hn::Max(hn::MulAdd(off, sharpness, hn::Set(d, 0.5f)), hn::Zero(d)), one);
    return hn::MulAdd(hn::Load(d, light.contrast + i), within, hn::Load(d, light.outside + i));
  }

  /// Composites all splats.
  /// @param until_overlap  no further than to where layers are found to cover each other in part
  HWY_INLINE void compose(bool until_overlap) {
    clear();
    const auto done = [&] { return lit == 0 || (until_overlap && overlap); };
    for (std::size_t e = 0; e < job.count; ++e) {
      if (e + kAhead < job.count) hwy::Prefetch(&job.splats[job.entries[e + kAhead]]);
      const Splat& splat = job.splats[job.entries[e]];

      // A gap in depth across the whole tile closes every layer; with no light left, the tile is
      // done.
      if (HWY_UNLIKELY(job.gap[e])) {
        flush(job.splats);
        closeAll();
        if (done()) break;
      }
      any_from_behind |= splat.opacity < 0.0f;
      batch.put(splat, job.entries[e]);
      if (batch.count < Batch::kMost) continue;
      flush(job.splats);
      if (done()) break;
    }
    flush(job.splats);
    closeAll();
  }

  /// Composites them as a part of the lens sees them.
  HWY_INLINE void compose(const PartSplats& splats, const PartView& view) {
    clear();
    const float side_px = static_cast<float>(job.samples - 1) / job.per_step;
    const glm::vec2 first_px(job.x, job.y), last_px = first_px + side_px;
    std::size_t at = 0;
    for (const std::size_t end : splats.ends) {
      any_from_behind = true;
      while (at < end && lit > 0) {
        at = splats.put(at, end, view, first_px, last_px, batch);
        if (at < end) flush(splats.splats.data());
      }
      flush(splats.splats.data());
      closeAll();
      if (lit == 0) break;
    }
  }

  /// Adds a share of what is composited to the result.
  void emit(float share) {
    const unsigned side = columns * kBlock;
    for (unsigned y = 0; y < side; ++y) {
      for (unsigned x = 0; x < side; ++x) {
        const Light& light = tile[y / kBlock * columns + x / kBlock].light;
        const unsigned i = y % kBlock * kBlock + x % kBlock;
        const float through = light.through[i];
        job.rgba[y * side + x] +=
            share * glm::vec4(light.red[i] + through * job.background[0],
                              light.green[i] + through * job.background[1],
                              light.blue[i] + through * job.background[2], 1.0f - through);
        if (kDepth) job.depth_m[y * side + x] += share * light.distance[i];
      }
    }
  }

  /// The lens as a whole; where layers cover each other in part, by its parts.
  std::size_t run() {
    const bool by_parts = kLens && job.parts && job.parts_share == 1.0f;
    compose(by_parts);
    if (!kLens || !job.parts || !overlap) {
      emit(1.0f);
      return fragments;
    }
    if (!by_parts) emit(1.0f - job.parts_share);
    return fragments + Parts(job).runParts();
  }

  std::size_t runParts() {
    const LensParts& parts = *job.parts;
    const bool round = !parts.out_across_D;
    static thread_local PartSplats splats;
    splats.reset(job.count);
    for (std::size_t e = 0; e < job.count; ++e) {
      const std::uint32_t splat = job.entries[e];
      if (e + kAhead < job.count) {
        const std::uint32_t later = job.entries[e + kAhead];
        hwy::Prefetch(&parts.splats[later]);
        hwy::Prefetch(&parts.out_of_focus_D[later]);
        hwy::Prefetch(&job.lens[later]);
      }
      if (job.gap[e]) splats.ends.push_back(e);
      splats.set(e, parts.splats[splat], parts.out_of_focus_D[splat],
                 round ? 0.0f : parts.out_across_D[splat], job.lens[splat]);
    }
    splats.ends.push_back(job.count);
    for (const glm::vec2& centre : parts.centres) {
      const glm::vec2 along = job.meridian, across(-along.y, along.x);
      compose(splats,
              {.centre = centre,
               .px_per_D = job.radius_px_per_D * (round ? centre : glm::dot(centre, along) * along),
               .across_px_per_D = job.radius_px_per_D * glm::dot(centre, across) * across});
      emit(job.parts_share / static_cast<float>(parts.centres.size()));
    }
    return fragments;
  }
};

}  // namespace HWY_NAMESPACE
}  // namespace foci
HWY_AFTER_NAMESPACE();

#endif  // FOCI_SWEEP_TILE_INL_H
