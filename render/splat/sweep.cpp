#include "render/splat/sweep.h"

#include <hwy/cache_control.h>
#include "app/base/parallel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "render/splat/interpolate.h"
#include "render/splat/limits.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/splat/sweep.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// After it:
#include "render/splat/layers-inl.h"

#ifndef FOCI_SWEEP_ONCE
#define FOCI_SWEEP_ONCE
namespace foci {

/// Less blur than this makes no difference to what hides what, pixels.
inline constexpr float kBlurred_px = 0.5f;

/// Less blur than this needs no parts of the lens, more than this is drawn by them alone, pixels:
/// in between both are mixed, so that a moving focus does not pop.
inline constexpr float kPartsFrom_px = 2.0f, kPartsFully_px = 4.0f;

struct TileJob {
  const Splat* splats;
  const std::uint32_t* entries;
  std::size_t count;
  const float* nearest_m;  // by entry: where its z-range or that of a later one begins first
  int samples;             // along a side, with the apron
  float x, y;              // of the first sample, pixels
  float lens_x, lens_y;    // what a mean radius counts along the axes, where pixels are oblong
  glm::vec2 meridian;      // of an astigmatic lens the nearest
  float per_step;          // 1 / the distance of samples, pixels
  float background[3];
  const SplatLens* lens;         // null: nothing is blurred
  const SplatLens* lens_across;  // null: the lens is round
  glm::vec2 radius_px_per_D;
  const LensParts* parts;  // null: never by parts
  float parts_share;       // of the picture, where it is drawn by them
  glm::vec4* rgba;         // samples x samples, all 0
  float* depth_m;          // likewise; null: not asked for
};

}  // namespace foci
#endif  // FOCI_SWEEP_ONCE

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

/// Lens points are in lens radii along the image's axes; where the lens is astigmatic, along its
/// nearest meridian and across it.
enum class Blur { none, round, astigmatic };

/// Draws the splats of a tile.
template <bool kTransparent, bool kDepth, Blur kBlur>
struct Sweep : Layers<kTransparent, kDepth, kBlur != Blur::none> {
  static constexpr bool kLens = kBlur != Blur::none, kAstigmatic = kBlur == Blur::astigmatic;
  using Base = Layers<kTransparent, kDepth, kLens>;
  using Base::addBeyond, Base::any_from_behind, Base::any_side, Base::blocks, Base::clear,
      Base::closeAll;
  using Base::Base, Base::tile;
  using Base::closeLayers, Base::columns, Base::kClosed, Base::mostThrough, Base::overlap;

  /// Adds one splat, moved by `shift`; returns the number of samples in its footprint.
  /// @param across  of an astigmatic lens
  /// @param part    the centre of the part of the lens, in its radii
  template <bool kSides>
  HWY_INLINE std::size_t add(const Splat& splat, const SplatLens& lens, const SplatLens& across,
                             const TileJob& job, const glm::vec2& shift, const glm::vec2& part) {
    const D d;
    const float left = (splat.x_px + shift.x - job.x) * job.per_step;
    const float top = (splat.y_px + shift.y - job.y) * job.per_step;
    const float extent_x = splat.extent_x_px * job.per_step;
    const float extent_y = splat.extent_y_px * job.per_step;
    const auto last = static_cast<float>(columns * kBlock - 1);
    if (left + extent_x < 0.0f || left - extent_x > last || top + extent_y < 0.0f ||
        top - extent_y > last) {
      return 0;
    }
    const float step2 = 1.0f / (job.per_step * job.per_step);
    const auto blockOf = [&](float sample) {
      return static_cast<unsigned>(std::clamp(sample, 0.0f, last)) / kBlock;
    };
    const unsigned x0 = blockOf(left - extent_x), x1 = blockOf(left + extent_x);
    const unsigned y0 = blockOf(top - extent_y), y1 = blockOf(top + extent_y);
    const unsigned wide = x1 - x0 + 1, count = wide * (y1 - y0 + 1);
    const V qa = hn::Set(d, splat.qa * step2), qb = hn::Set(d, splat.qb * step2);
    const V qc = hn::Set(d, splat.qc * step2);
    const V k0 = hn::Set(d, splat.k0), k1 = hn::Set(d, splat.k1), k2 = hn::Set(d, splat.k2);
    const V red = hn::Set(d, splat.red), green = hn::Set(d, splat.green);
    const V blue = hn::Set(d, splat.blue), opacity = hn::Set(d, std::abs(splat.opacity));
    const bool from_behind = splat.opacity < 0.0f;
    any_from_behind |= from_behind;
    const V near_m = hn::Set(d, splat.near_m), far_m = hn::Set(d, splat.far_m);
    const V distance = hn::Mul(hn::Mul(hn::Set(d, 0.5f), hn::Add(near_m, far_m)), opacity);
    const V one = hn::Set(d, 1.0f);
    const V per_x = hn::Set(d, lens.per_px * job.lens_x / job.per_step);
    const V per_y = hn::Set(d, lens.per_px * job.lens_y / job.per_step);
    const V inv_width = hn::Set(d, lens.inv_width);
    [[maybe_unused]] V along_x, along_y, across_x, across_y, width2, across_width2;
    if constexpr (kAstigmatic) {
      const float x = job.meridian.x * job.lens_x, y = job.meridian.y * job.lens_y;
      along_x = hn::Set(d, lens.per_px * x / job.per_step);
      along_y = hn::Set(d, lens.per_px * y / job.per_step);
      across_x = hn::Set(d, -across.per_px * job.meridian.y * job.lens_x / job.per_step);
      across_y = hn::Set(d, across.per_px * job.meridian.x * job.lens_y / job.per_step);
      width2 = hn::Set(d, 1.0f / (lens.inv_width * lens.inv_width));
      across_width2 = hn::Set(d, 1.0f / (across.inv_width * across.inv_width));
    }

    bool tilted = false;
    [[maybe_unused]] V tilt_x, tilt_y, tilt_at;
    if constexpr (kLens) {
      const glm::vec2 tilt(lens.tilt_x, lens.tilt_y), m = job.meridian;
      tilted = tilt != glm::vec2(0.0f);
      tilt_at = hn::Set(d, 1.0f + glm::dot(tilt, part));
      tilt_x = hn::Set(d, kAstigmatic ? glm::dot(tilt, m) : tilt.x);
      tilt_y = hn::Set(d, kAstigmatic ? tilt.y * m.x - tilt.x * m.y : tilt.y);
    }

    std::size_t fragments = 0;
    // One flat loop over the blocks that the box may touch: two nested short ones mispredict.
    unsigned index = y0 * columns + x0, column = 0;
    float from_x = static_cast<float>(x0 * kBlock) - left;
    float from_y = static_cast<float>(y0 * kBlock) - top;
    const float back = static_cast<float>((wide - 1) * kBlock);
    for (unsigned b = 0; b < count; ++b) {
      Block& block = tile[index];
      Sums& sums = from_behind ? block.from_behind : block.facing;
      Light& light = block.light;
      const V at_x = hn::Set(d, from_x), at_y = hn::Set(d, from_y);
      for (std::size_t i = 0; i < kBlockSamples; i += hn::Lanes(d)) {
        const V dx = hn::Add(hn::Load(d, kPlaces.x + i), at_x);
        const V dy = hn::Add(hn::Load(d, kPlaces.y + i), at_y);
        const V slope = hn::MulAdd(qa, dx, hn::Mul(qb, dy));
        const V t = hn::NegMulAdd(slope, dx, hn::NegMulAdd(hn::Mul(qc, dy), dy, one));
        const M inside = hn::Gt(t, hn::Zero(d));
        fragments += hn::CountTrue(d, inside);

        const V open = hn::Load(d, block.far_m + i);
        const M behind = hn::And(inside, hn::Gt(near_m, open));
        if (HWY_UNLIKELY(!hn::AllFalse(d, behind))) closeLayers(index, i, behind);

        V all = hn::IfThenElseZero(inside, hn::MulAdd(hn::MulAdd(k2, t, k1), t, k0));
        [[maybe_unused]] V lx, ly;
        if constexpr (kLens) {
          if constexpr (kAstigmatic) {
            lx = hn::MulAdd(dx, along_x, hn::Mul(dy, along_y));
            ly = hn::MulAdd(dx, across_x, hn::Mul(dy, across_y));
          } else {
            lx = hn::Mul(dx, per_x);
            ly = hn::Mul(dy, per_y);
          }
          if (tilted) {
            const V times = hn::MulAdd(tilt_x, lx, hn::MulAdd(tilt_y, ly, tilt_at));
            all = hn::Mul(all, hn::Abs(times));
          }
        }
        // What comes once the surface is whole lies behind it.
        const V before = hn::Load(d, sums.weight + i);
        const V w = hn::Min(all, hn::Max(hn::Sub(hn::Set(d, kWhole), before), hn::Zero(d)));
        hn::Store(hn::Add(all, before), d, sums.weight + i);
        V passes = one;  // of the light, by where on the lens it falls
        if constexpr (kLens) {
          hn::Store(hn::MulAdd(w, lx, hn::Load(d, sums.lens_x + i)), d, sums.lens_x + i);
          hn::Store(hn::MulAdd(w, ly, hn::Load(d, sums.lens_y + i)), d, sums.lens_y + i);
          if constexpr (kSides) {
            const V off = hn::NegMulAdd(
                hn::Load(d, light.side_x + i), lx,
                hn::NegMulAdd(hn::Load(d, light.side_y + i), ly, hn::Load(d, light.side_at + i)));
            V sharpness = inv_width;
            if constexpr (kAstigmatic) {
              // The variance along the side's normal, whose parts' squares sum to 1.
              const V n = hn::Load(d, light.side_x + i);
              const V squared =
                  hn::MulAdd(hn::Mul(n, n), hn::Sub(width2, across_width2), across_width2);
              sharpness = hn::Div(one, hn::Sqrt(squared));
            }
            const V within =
                hn::Min(hn::Max(hn::MulAdd(off, sharpness, hn::Set(d, 0.5f)), hn::Zero(d)), one);
            passes =
                hn::MulAdd(hn::Load(d, light.contrast + i), within, hn::Load(d, light.outside + i));
          }
        }
        const V seen = hn::Mul(w, passes);
        const auto accumulate = [&](float* sum, V value) {
          hn::Store(hn::MulAdd(seen, value, hn::Load(d, sum + i)), d, sum + i);
        };
        accumulate(sums.red, red);
        accumulate(sums.green, green);
        accumulate(sums.blue, blue);
        if constexpr (kTransparent || kLens) accumulate(sums.visible, opacity);
        if constexpr (kDepth) accumulate(sums.distance, distance);
        hn::Store(hn::IfThenElse(inside, hn::Max(open, far_m), open), d, block.far_m + i);
        if constexpr (kTransparent) {
          const V later = hn::Sub(all, w);
          if (!from_behind && !hn::AllTrue(d, hn::Le(later, hn::Zero(d)))) {
            addBeyond(index, i, hn::Mul(later, passes), splat);
          }
        }
      }
      const bool row_ends = ++column == wide;
      index += row_ends ? columns - wide + 1 : 1;
      from_x += row_ends ? -back : static_cast<float>(kBlock);
      from_y += row_ends ? static_cast<float>(kBlock) : 0.0f;
      column = row_ends ? 0 : column;
    }
    return fragments;
  }

  /// Composites all splats as seen through a part of the lens, from its centre or shifted.
  template <class ShiftOf>
  HWY_INLINE std::size_t compose(const TileJob& job, const Splat* splats, const SplatLens* lenses,
                                 const SplatLens* lenses_across, const ShiftOf& shiftOf,
                                 const glm::vec2& part) {
    clear();
    std::size_t fragments = 0;
    float open_far_m = job.count > 0 ? splats[job.entries[0]].far_m : 0.0f;
    for (std::size_t e = 0; e < job.count; ++e) {
      constexpr std::size_t kAhead = 8;
      if (e + kAhead < job.count) hwy::Prefetch(&splats[job.entries[e + kAhead]]);
      const Splat& splat = splats[job.entries[e]];

      // A gap in depth across the whole tile closes every layer; with no light left, the tile is
      // done.
      if (HWY_UNLIKELY(job.nearest_m[e] > open_far_m)) {
        closeAll();
        if (mostThrough() < kHidden) break;
      }
      open_far_m = std::max(open_far_m, splat.far_m);
      const SplatLens lens = kLens ? lenses[job.entries[e]] : SplatLens{};
      const SplatLens across = kAstigmatic ? lenses_across[job.entries[e]] : SplatLens{};
      const glm::vec2 shift = shiftOf(job.entries[e]);
      fragments += kLens && any_side ? add<true>(splat, lens, across, job, shift, part)
                                     : add<false>(splat, lens, across, job, shift, part);
    }
    closeAll();
    return fragments;
  }

  /// Adds a share of what is composited to the result.
  void emit(const TileJob& job, float share) {
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

  std::size_t run(const TileJob& job) {
    const LensParts* parts = job.parts;
    std::size_t fragments = 0;
    fragments += compose(
        job, job.splats, job.lens, job.lens_across, [](std::uint32_t) { return glm::vec2(0.0f); },
        glm::vec2(0.0f));
    if (!parts || !overlap) {
      emit(job, 1.0f);
      return fragments;
    }
    emit(job, 1.0f - job.parts_share);
    for (const glm::vec2& centre : parts->centres) {
      const glm::vec2 across(-job.meridian.y, job.meridian.x);
      const glm::vec2 px_per_D =
          job.radius_px_per_D *
          (kAstigmatic ? glm::dot(centre, job.meridian) * job.meridian : centre);
      const glm::vec2 across_px_per_D =
          job.radius_px_per_D * (kAstigmatic ? glm::dot(centre, across) * across : glm::vec2(0.0f));
      fragments += compose(
          job, parts->splats, parts->lens, parts->lens_across,
          [&](std::uint32_t splat) {
            const glm::vec2 shift = px_per_D * parts->out_of_focus_D[splat];
            return kAstigmatic ? shift + across_px_per_D * parts->out_across_D[splat] : shift;
          },
          std::sqrt(static_cast<float>(parts->centres.size())) * centre);
      emit(job, job.parts_share / static_cast<float>(parts->centres.size()));
    }
    return fragments;
  }
};

std::size_t sweepTile(const TileJob& job, bool transparent) {
  const auto run = [&]<bool kTransparent, bool kDepth>() {
    if (job.lens && job.lens_across)
      return Sweep<kTransparent, kDepth, Blur::astigmatic>(job.samples).run(job);
    if (job.lens) return Sweep<kTransparent, kDepth, Blur::round>(job.samples).run(job);
    return Sweep<kTransparent, kDepth, Blur::none>(job.samples).run(job);
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

std::uint64_t sweep(const SplatChunks& chunks, const TileLists& lists,
                    const SweepSettings& settings, Frame& frame) {
  std::vector<std::size_t> fragments(lists.tiles().size());
  const glm::vec2 meridian = nearestMeridian(settings.defocus);
  parallelFor(lists.tiles().size(), [&](std::size_t t) {
    const Tile& tile = lists.tiles()[t];
    const auto list = lists.splats(t);
    std::vector<float> nearest_m(list.size());
    float least_m = std::numeric_limits<float>::infinity();
    for (std::size_t e = list.size(); e-- > 0;) {
      nearest_m[e] = least_m = std::min(least_m, chunks.splats[list[e]].near_m);
    }
    constexpr int kMost = kTile + 2 * kApron;
    alignas(64) glm::vec4 rgba[kMost * kMost]{};
    float depth_m[kMost * kMost]{};
    const auto step_px = static_cast<float>(tile.step_px);
    const float first_px = step_px * (0.5f - static_cast<float>(tile.apron()));
    const glm::vec2 radius = settings.defocus.radius_px_per_D;
    const float oblong = radius.x > 0.0f && radius.y > 0.0f ? std::sqrt(radius.y / radius.x) : 1.0f;
    const TileJob job{
        .splats = chunks.splats.get(),
        .entries = list.data(),
        .count = list.size(),
        .nearest_m = nearest_m.data(),
        .samples = tile.samplesWithApron(),
        .x = static_cast<float>(tile.x_px) + first_px,
        .y = static_cast<float>(tile.y_px) + first_px,
        .lens_x = oblong,
        .lens_y = 1.0f / oblong,
        .meridian = meridian,
        .per_step = 1.0f / step_px,
        .background = {settings.background.r, settings.background.g, settings.background.b},
        .lens = tile.blur_px > kBlurred_px ? chunks.lens.get() : nullptr,
        .lens_across = chunks.lens_across.get(),
        .radius_px_per_D = radius,
        .parts = tile.blur_px > kPartsFrom_px ? settings.parts : nullptr,
        .parts_share =
            std::min((tile.blur_px - kPartsFrom_px) / (kPartsFully_px - kPartsFrom_px), 1.0f),
        .rgba = rgba,
        .depth_m = settings.depth ? depth_m : nullptr};
    fragments[t] = HWY_DYNAMIC_DISPATCH(sweepTile)(job, settings.transparent);
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
