// Composites the splats of one tile: through the whole aperture, or, where layers cover each other
// in part, through each sub-aperture. Included once a SIMD target.
#if defined(FOCI_SWEEP_TILE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FOCI_SWEEP_TILE_INL_H
#undef FOCI_SWEEP_TILE_INL_H
#else
#define FOCI_SWEEP_TILE_INL_H
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>

#include "render/kernel/kernel.h"
#include "render/splat/batch-inl.h"
#include "render/splat/layers-inl.h"
#include "render/splat/open_layer-inl.h"
#include "render/splat/splat.h"
#include "render/splat/tile_job.h"

HWY_BEFORE_NAMESPACE();
namespace foci {
namespace HWY_NAMESPACE {
/// Sample positions in a block, relative to the first.
struct SamplePlaces {
  alignas(64) BlockValues x, y;
  constexpr SamplePlaces() : x(), y() {
    for (int i = 0; i < kBlockSamples; ++i) {
      x[i] = static_cast<float>(i % kBlock);
      y[i] = static_cast<float>(i / kBlock);
    }
  }
};
constexpr SamplePlaces kSamplePlaces;

/// How the splats at hand are blurred. The whole-aperture passes, `round` and `astigmatic`, note
/// the mean lens point of each layer: along the image's axes, or along the lens's nearest meridian
/// and across it. A sub-aperture is too small to need lens points.
enum class Blur { none, sub_aperture, round, astigmatic };
constexpr bool isWholeAperture(Blur blur) {
  return blur == Blur::round || blur == Blur::astigmatic;
}

/// One tile's sweep.
template <bool kTransparent, bool kDepth, Blur kBlur>
struct Sweep : Layers<kTransparent, kDepth, isWholeAperture(kBlur)> {
  static constexpr bool kAstigmatic = kBlur == Blur::astigmatic;
  static constexpr bool kLens = isWholeAperture(kBlur);
  using Base = Layers<kTransparent, kDepth, kLens>;
  using Open = OpenLayer<kTransparent, kDepth, kLens>;
  using SubApertureSweep = Sweep<kTransparent, kDepth, Blur::sub_aperture>;
  using Base::addBeyond, Base::any_back_facing, Base::blocks, Base::clear, Base::closeAll,
      Base::tile;
  using Base::becomesOpaque, Base::closeLayers, Base::columns, Base::overlap, Base::translucent;

  const TileJob& job;
  Batch batch;
  std::size_t fragments = 0;

  explicit Sweep(const TileJob& tile_job)
      : Base(tile_job.samples, tile_job.coverage, kLens ? tile_job.ramp : kSharpRamp),
        job(tile_job) {}

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
        if (touching == 0 || block.opaque) continue;
        for (std::size_t i = 0; i < kBlockSamples && !block.opaque; i += hn::Lanes(D())) {
          add(splats, index, i, static_cast<float>(x * kBlock), static_cast<float>(y * kBlock),
              touching);
        }
      }
    }
    batch.count = 0;
  }

  /// Adds splats of the batch to a block's samples from `i` on, as many samples as SIMD lanes.
  HWY_NOINLINE void add(const Splat* splats, std::size_t index, std::size_t i, float at_x,
                        float at_y, std::uint64_t touching) {
    const D d;
    Block& block = tile[index];
    const V one = hn::Set(d, 1.0f), zero = hn::Zero(d), step = hn::Set(d, 1.0f / job.per_step);
    const V x = hn::MulAdd(hn::Add(hn::Load(d, kSamplePlaces.x + i), hn::Set(d, at_x)), step,
                           hn::Set(d, job.x));
    const V y = hn::MulAdd(hn::Add(hn::Load(d, kSamplePlaces.y + i), hn::Set(d, at_y)), step,
                           hn::Set(d, job.y));
    Sums* sums = &block.facing;
    Open layer;
    layer.load(block, *sums, i);

    for (; touching != 0; touching &= touching - 1) {
      const auto n = static_cast<unsigned>(std::countr_zero(touching));
      const Splat& splat = splats[batch.splat[n]];
      Sums* side = splat.opacity < 0.0f ? &block.back_facing : &block.facing;
      if (HWY_UNLIKELY(side != sums)) {
        layer.store(block, *sums, i);
        sums = side;
        layer.load(block, *sums, i);
      }

      // Find the samples inside the footprint.
      const V dx = hn::Sub(x, hn::Set(d, batch.x_px[n])),
              dy = hn::Sub(y, hn::Set(d, batch.y_px[n]));
      const V slope = hn::MulAdd(hn::Set(d, splat.qa), dx, hn::Mul(hn::Set(d, splat.qb), dy));
      const V t =
          hn::NegMulAdd(slope, dx, hn::NegMulAdd(hn::Mul(hn::Set(d, splat.qc), dy), dy, one));
      const M inside = hn::Gt(t, zero);
      fragments += hn::CountTrue(d, inside);

      // Close the layers that end before the splat begins.
      const V near_m = hn::Set(d, splat.near_m);
      const M behind =
          hn::And(inside, hn::And(hn::Gt(near_m, layer.far_m), hn::Ge(layer.far_m, zero)));
      if (HWY_UNLIKELY(!hn::AllFalse(d, behind))) {
        if (!close(index, i, behind, *sums, layer)) return;
      }
      layer.far_m =
          hn::IfThenElse(inside, hn::Max(layer.far_m, hn::Set(d, splat.far_m)), layer.far_m);

      // Evaluate the kernel, and note which point of the lens sees the splat.
      V all = kernelAt(splat, n, t, inside);
      LensPoint point;
      V reaching = one;  // share of the light that reaches the splat, by its lens point
      if constexpr (kLens) {
        const SplatLens& lens = job.lens[batch.splat[n]];
        const SplatLens& across =
            kAstigmatic ? job.lens_across[batch.splat[n]] : job.lens[batch.splat[n]];
        point = lensPointAt<kAstigmatic>(job, lens, across, dx, dy);
        layer.addLensPoints(all, point, lens.inv_width, across.inv_width);
        if (lens.tilt_x != 0.0f || lens.tilt_y != 0.0f) {
          all = hn::Mul(all, tiltFactor<kAstigmatic>(job, lens, point));
        }
        if (block.any_edge)
          reaching = edgeTransmittance<kAstigmatic>(block.light, i, point, lens, across);
      } else {
        const V by_radius = hn::Mul(all, hn::Set(d, batch.inv_radius[n]));
        layer.mean_x = hn::NegMulAdd(by_radius, dx, layer.mean_x);
        layer.mean_y = hn::NegMulAdd(by_radius, dy, layer.mean_y);
      }
      const V taken = layer.taken(all), seen = layer.seen(all, reaching);
      layer.weight = hn::Add(layer.weight, all);
      layer.addColour(splat, seen);
      if constexpr (kLens) layer.addBlocked(splat, seen, point);

      // Behind an opaque surface of a transparent tile a second surface begins.
      if constexpr (kTransparent) {
        const V later = hn::Sub(all, taken);
        if (side != &block.facing || hn::AllTrue(d, hn::Le(later, zero))) continue;
        addBeyond(index, i, hn::Mul(later, reaching), splat);
        const M full = hn::Ge(layer.weight, hn::Set(d, kOpaqueWeight + 1.0f));
        if (HWY_LIKELY(hn::AllFalse(d, full))) continue;
        if (!close(index, i, full, *sums, layer)) return;
      }
    }
    layer.store(block, *sums, i);
  }

  /// Closes the layers of the lanes in `which`. False if the block is opaque now.
  HWY_INLINE bool close(std::size_t index, std::size_t i, M which, Sums& sums, Open& layer) {
    Block& block = tile[index];
    layer.store(block, sums, i);
    closeLayers(index, i, which);
    if (becomesOpaque(block)) return false;
    layer.load(block, sums, i);
    return true;
  }

  /// A splat's weights at t = 1 - q (kernel.h); 0 outside the footprint.
  HWY_INLINE V kernelAt(const Splat& splat, unsigned n, V t, M inside) const {
    const D d;
    const V rim = hn::Mul(t, hn::MulAdd(hn::Set(d, splat.k2), t, hn::Set(d, splat.k1)));
    V weight = hn::IfThenElseZero(inside, hn::Min(hn::Set(d, splat.k0), rim));
    if constexpr (kBlur == Blur::sub_aperture) weight = hn::Mul(weight, hn::Set(d, batch.size[n]));
    return weight;
  }

  /// Composites all splats as the whole aperture sees them.
  /// @param until_overlap  stop at the first layers that cover each other in part
  HWY_INLINE void compose(bool until_overlap) {
    clear();
    const auto done = [&] { return translucent == 0 || (until_overlap && overlap); };
    for (std::size_t e = 0; e < job.count; ++e) {
      if (e + kAhead < job.count) {
        const std::uint32_t later = job.entries[e + kAhead];
        hwy::Prefetch(&job.splats[later]);
        if constexpr (kLens) hwy::Prefetch(&job.lens[later]);
        if constexpr (kAstigmatic) hwy::Prefetch(&job.lens_across[later]);
      }
      const Splat& splat = job.splats[job.entries[e]];

      // A gap in depth across the whole tile closes every layer.
      if (HWY_UNLIKELY(job.gap[e])) {
        flush(job.splats);
        closeAll();
        if (done()) break;
      }
      any_back_facing |= splat.opacity < 0.0f;
      batch.put(splat, job.entries[e]);
      if (batch.count < Batch::kCapacity) continue;
      flush(job.splats);
      if (done()) break;
    }
    flush(job.splats);
    closeAll();
  }

  /// Composites all splats as one sub-aperture sees them.
  HWY_INLINE void compose(const SubApertureSplats& splats, const SubApertureView& view) {
    clear();
    const float side_px = static_cast<float>(job.samples - 1) / job.per_step;
    const glm::vec2 first_px(job.x, job.y), last_px = first_px + side_px;
    std::size_t at = 0;
    for (const std::size_t end : splats.ends) {
      any_back_facing = true;
      while (at < end && translucent > 0) {
        at = splats.put(at, end, view, first_px, last_px, batch);
        if (at < end) flush(splats.splats.data());
      }
      flush(splats.splats.data());
      closeAll();
      if (translucent == 0) break;
    }
  }

  /// Adds `share` of the composite, over the background, to the tile's samples.
  void emit(float share) {
    const unsigned side = columns * kBlock;
    for (unsigned y = 0; y < side; ++y) {
      for (unsigned x = 0; x < side; ++x) {
        const Light& light = tile[y / kBlock * columns + x / kBlock].light;
        const unsigned i = y % kBlock * kBlock + x % kBlock;
        const float transmittance = light.transmittance[i];
        glm::vec4& sum = job.rgba[y * side + x];
        sum += share * glm::vec4(light.red[i] + transmittance * job.background[0],
                                 light.green[i] + transmittance * job.background[1],
                                 light.blue[i] + transmittance * job.background[2],
                                 1.0f - transmittance);
        sum.a = std::min(sum.a, 1.0f);  // of rounded shares
        if (kDepth) job.depth_m[y * side + x] += share * light.distance[i];
      }
    }
  }

  /// Renders the tile through the whole aperture. Where layers cover each other in part, mixes the
  /// sub-apertures in, or uses them alone.
  /// @return the number of fragments
  static std::size_t run(const TileJob& job) {
    const bool sub_apertures_only = kLens && job.sub_apertures && job.sub_aperture_share == 1.0f;
    std::size_t fragments = 0;
    const bool has_gap = std::find(job.gap, job.gap + job.count, 1) != job.gap + job.count;
    if (sub_apertures_only && has_gap) {
      const TileJob few = someSamples(job);  // outlives the sweep of it
      Sweep some(few);
      some.compose(true);
      fragments = some.fragments;
      if (some.overlap) return fragments + SubApertureSweep(job).runSubApertures();
    }
    Sweep whole(job);
    whole.compose(sub_apertures_only);
    fragments += whole.fragments;
    if (!kLens || !job.sub_apertures || !whole.overlap) {
      whole.emit(1.0f);
      return fragments;
    }
    if (!sub_apertures_only) whole.emit(1.0f - job.sub_aperture_share);
    return fragments + SubApertureSweep(job).runSubApertures();
  }

  /// The tile with a few of its samples. They find most overlaps, which are about as wide as the
  /// blur, in a fraction of the time. A list without a gap in depth more often holds one surface.
  static TileJob someSamples(const TileJob& job) {
    TileJob some = job;
    some.samples = std::min(job.samples, 2 * kBlock);
    some.per_step =
        job.per_step * static_cast<float>(some.samples - 1) / static_cast<float>(job.samples - 1);
    return some;
  }

  /// Renders the tile through each sub-aperture and adds the mean.
  std::size_t runSubApertures() {
    const SubApertures& all = *job.sub_apertures;
    const bool round = !all.out_across_D;
    static thread_local SubApertureSplats splats;
    gather(splats);
    if (job.local) {
      const std::vector<glm::vec2> shifts_px = comaShifts_px(*job.local, all.centres);
      for (std::size_t i = 0; i < all.centres.size(); ++i) {
        const glm::vec2 centre = all.centres[i];
        compose(splats, {.centre = centre,
                         .px_per_D = glm::vec2(centre.x),
                         .across_px_per_D = glm::vec2(centre.y),
                         .shift_px = shifts_px[i]});
        emit(job.sub_aperture_share / static_cast<float>(all.centres.size()));
      }
      return fragments;
    }
    for (const glm::vec2& centre : all.centres) {
      const glm::vec2 along = job.meridian, across(-along.y, along.x);
      compose(splats,
              {.centre = centre,
               .px_per_D = job.radius_px_per_D * (round ? centre : glm::dot(centre, along) * along),
               .across_px_per_D = job.radius_px_per_D * glm::dot(centre, across) * across});
      emit(job.sub_aperture_share / static_cast<float>(all.centres.size()));
    }
    return fragments;
  }

  /// Copies the tile's splats from the frame.
  void gather(SubApertureSplats& splats) const {
    const SubApertures& all = *job.sub_apertures;
    splats.reset(job.count);
    splats.by_matrix = all.lens_px != nullptr;
    for (std::size_t e = 0; e < job.count; ++e) {
      const std::uint32_t splat = job.entries[e];
      if (e + kAhead < job.count) {
        const std::uint32_t later = job.entries[e + kAhead];
        hwy::Prefetch(&all.splats[later]);
        if (all.lens_px) {
          hwy::Prefetch(&all.lens_px[later]);
        } else {
          hwy::Prefetch(&all.out_of_focus_D[later]);
        }
        hwy::Prefetch(&job.lens[later]);
      }
      if (job.gap[e]) splats.ends.push_back(e);
      splats.set(e, all.splats[splat], all.lens_px ? 0.0f : all.out_of_focus_D[splat],
                 all.out_across_D ? all.out_across_D[splat] : 0.0f, job.lens[splat]);
      if (all.lens_px) splats.setMatrix(e, all.lens_px[splat]);
    }
    splats.ends.push_back(job.count);
  }
};

}  // namespace HWY_NAMESPACE
}  // namespace foci
HWY_AFTER_NAMESPACE();

#endif  // FOCI_SWEEP_TILE_INL_H
