#include "render/splat/sweep.h"

#include <hwy/cache_control.h>

#include "base/parallel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include "render/kernel/kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/splat/sweep.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// After foreach_target.h:
#include "render/splat/sweep_tile-inl.h"

HWY_BEFORE_NAMESPACE();
namespace foci {
namespace HWY_NAMESPACE {

std::size_t sweepTile(const TileJob& job, bool transparent) {
  const auto run = [&]<bool kTransparent, bool kDepth>() {
    if (job.lens && job.lens_across) return Sweep<kTransparent, kDepth, Blur::astigmatic>::run(job);
    if (job.lens) return Sweep<kTransparent, kDepth, Blur::round>::run(job);
    return Sweep<kTransparent, kDepth, Blur::none>::run(job);
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

namespace {

/// What a tile's list tells of all its splats. One object serves tile after tile, so it allocates
/// seldom.
struct ListSurvey {
  /// By entry: whether all splats before it end nearer than it and all splats after it begin.
  std::vector<std::uint8_t> gap;
  bool transparent = false;  ///< some splat's opacity is below 1

  void read(const Splat* splats, std::span<const std::uint32_t> list) {
    nearest_m_.resize(list.size());
    far_m_.resize(list.size());
    gap.resize(list.size());
    float min_m = std::numeric_limits<float>::infinity(), min_opacity = 1.0f;
    for (std::size_t e = list.size(); e-- > 0;) {
      if (e >= kAhead) hwy::Prefetch(&splats[list[e - kAhead]]);
      const Splat& splat = splats[list[e]];
      nearest_m_[e] = min_m = std::min(min_m, splat.near_m);
      far_m_[e] = splat.far_m;
      min_opacity = std::min(min_opacity, std::abs(splat.opacity));
    }
    transparent = min_opacity < 0.9999f;                        // a node rounds its opacity
    float farthest_m = std::numeric_limits<float>::infinity();  // no gap before the first entry
    for (std::size_t e = 0; e < list.size(); ++e) {
      gap[e] = nearest_m_[e] > farthest_m;
      farthest_m = e == 0 ? far_m_[0] : std::max(farthest_m, far_m_[e]);
    }
  }

 private:
  std::vector<float> nearest_m_, far_m_;  // nearest of an entry and all after it; of the entry
};

}  // namespace

std::uint64_t sweep(const SplatChunks& chunks, const TileLists& lists,
                    const SweepSettings& settings, Frame& frame) {
  const std::size_t tile_count = lists.tiles().size();
  std::vector<std::size_t> fragments(tile_count);
  const glm::vec2 meridian = nearestMeridian(settings.defocus);
  parallelFor(tile_count, [&](std::size_t t) {
    const Tile& tile = lists.tiles()[t];
    const auto list = lists.splats(t);
    static thread_local ListSurvey survey;
    survey.read(chunks.splats.get(), list);
    alignas(64) glm::vec4 rgba[kMostSamples * kMostSamples]{};
    float depth_m[kMostSamples * kMostSamples]{};
    const auto step_px = static_cast<float>(tile.step_px);
    const float first_px = step_px * (0.5f - static_cast<float>(tile.apron()));
    const glm::vec2 radius = settings.defocus.radius_px_per_D;
    const LensField* field = chunks.lens_across ? shownField(settings.defocus) : nullptr;
    const glm::vec2 middle_px = glm::vec2(tile.x_px, tile.y_px) +
                                0.5f * static_cast<float>(tile.side_px) - settings.principal_px;
    const float oblong =
        !field && radius.x > 0.0f && radius.y > 0.0f ? std::sqrt(radius.y / radius.x) : 1.0f;
    const TileJob job{
        .splats = chunks.splats.get(),
        .entries = list.data(),
        .count = list.size(),
        .gap = survey.gap.data(),
        .samples = tile.samplesWithApron(),
        .x = static_cast<float>(tile.x_px) + first_px,
        .y = static_cast<float>(tile.y_px) + first_px,
        .lens_x = oblong,
        .lens_y = 1.0f / oblong,
        .meridian = field ? field->meridianAt(middle_px, settings.defocus) : meridian,
        .per_step = 1.0f / step_px,
        .background = {settings.background.r, settings.background.g, settings.background.b},
        .coverage = closingFactor(settings.low_pass_px, tile.blur_px),
        .ramp = rampUnderBlur(tile.blur_px / step_px),
        .lens = tile.blur_px > kBlurredSteps * step_px ? chunks.lens.get() : nullptr,
        .lens_across = chunks.lens_across.get(),
        .radius_px_per_D = radius,
        .sub_apertures = tile.blur_px > kSubAperturesFrom_px ? settings.sub_apertures : nullptr,
        .sub_aperture_share = std::min(
            (tile.blur_px - kSubAperturesFrom_px) / (kSubAperturesOnly_px - kSubAperturesFrom_px),
            1.0f),
        .local = field ? std::optional(field->at(middle_px)) : std::nullopt,
        .rgba = rgba,
        .depth_m = settings.depth ? depth_m : nullptr};
    fragments[t] = HWY_DYNAMIC_DISPATCH(sweepTile)(job, survey.transparent);
    interpolateTile(tile, rgba, job.depth_m, 1.0f, frame);
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
