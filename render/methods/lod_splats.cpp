#include "render/methods/lod_splats.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/mapped_file.h"
#include "base/parallel.h"
#include "render/methods/lens_samples.h"
#include "render/methods/mean_of_parts.h"
#include "render/methods/view_splats.h"

namespace foci {
namespace {

/// A multiple of the widest tile, so that strips have the tiles of the whole frame.
constexpr int kStrip_px = kTile * kMaxStep_px;

/// The lens is the caller's.
SweepSettings sweepSettings(const RenderSettings& settings, const LodSettings& lod) {
  return {.background = settings.background,
          .defocus = {},
          .low_pass_px = lod.low_pass_px,
          .depth = settings.depth};
}

/// Begins to read a cut's surfels from their file, in parts much longer than those that a page
/// fault reads. Parts that are apart by less than a part's length are joined.
void readSurfelsAhead(const SurfelCloud& surfels, const Cut& cut) {
  constexpr std::uint32_t kJoined = 1 << 14;
  if (!surfels.position_m.isMapped()) return;
  std::vector<CutRange> parts;
  const auto add = [&](std::uint32_t begin, std::uint32_t end) {
    if (!parts.empty() && begin >= parts.back().begin && begin <= parts.back().end + kJoined) {
      parts.back().end = std::max(parts.back().end, end);
    } else {
      parts.push_back({begin, end});
    }
  };
  for (const CutRange& range : cut.ranges) add(range.begin, range.end);
  for (const CutEntry& entry : cut.surfels) add(entry.index, entry.index + 1);
  parallelFor(parts.size(), [&](std::size_t i) {
    const auto read = [&](const auto& values) {
      readAhead({reinterpret_cast<const unsigned char*>(values.data() + parts[i].begin),
                 (parts[i].end - parts[i].begin) * sizeof(values[0])});
    };
    read(surfels.position_m);
    read(surfels.axis_u_m);
    read(surfels.axis_v_m);
    read(surfels.area_m2);
    read(surfels.color);
    if (!surfels.opacity.empty()) read(surfels.opacity);
  });
}

/// Copies a frame into another one of the same height, from the column `x_px` on.
void copyColumns(const Frame& from, int x_px, Frame& to) {
  for (int y = 0; y < from.size_px.y; ++y) {
    const auto row = static_cast<std::ptrdiff_t>(y) * from.size_px.x;
    const auto at = static_cast<std::ptrdiff_t>(y) * to.size_px.x + x_px;
    std::copy_n(from.rgba.begin() + row, from.size_px.x, to.rgba.begin() + at);
    if (!from.depth_m.empty()) {
      std::copy_n(from.depth_m.begin() + row, from.size_px.x, to.depth_m.begin() + at);
    }
  }
}

}  // namespace

LodSplats::LodSplats(const SurfelCloud& cloud, const SharedGpu& gpu) : tree_(treeOf(cloud)) {
  if (gpu) gpu_.emplace(std::make_shared<GpuScene>(gpu, *tree_));
}

LodSplats::LodSplats(const LodSplats& other, std::nullptr_t) : tree_(other.tree_) {
  if (other.gpu_) gpu_.emplace(other.gpu_->scene());
}

RenderStats LodSplats::render(const View& view, const RenderSettings& settings,
                              const LodSettings& lod, Frame& frame) {
  const glm::vec2 radius_px_per_D = settings.defocus.radius_px_per_D;
  const bool blurred = radius_px_per_D.x * radius_px_per_D.y > 0.0f;
  if (blurred && settings.pupil.hasParts()) return renderParts(view, settings, lod, frame);
  LodSettings softened = lod;
  softened.cut.acuity = widened(lod.cut.acuity, settings.pupil);
  return renderLens(view, settings, softened, frame);
}

RenderStats LodSplats::renderParts(const View& view, const RenderSettings& settings,
                                   const LodSettings& lod, Frame& frame) {
  const std::vector<LensPart> parts = partsFor(settings.defocus, settings.pupil, lod.sub_apertures);
  RenderStats stats;
  meanOfParts(parts, settings.pupil.diffraction_px, part_, frame,
              [&](const LensPart& part, Frame& to) {
                const View seen = viewOfPart(view, part);
                RenderSettings of_part = settings;
                of_part.defocus = part.defocus;
                LodSettings detail = lod;
                detail.cut.acuity = widened(lod.cut.acuity, part);
                detail.cut.per_blur2 *= part.radius * part.radius;
                detail.sub_apertures = 1;
                if (gpu_) {
                  GpuRequest request = gpuRequest(seen, of_part, detail);
                  request.lens = part.centre;
                  request.aperture = part.radius;
                  stats.add(statsOf(gpu_->render(request, to.gpu)));
                  return;
                }
                stats.add(renderSplats(
                    seen, part.defocus, detail,
                    {.lens = part.centre, .aperture = part.radius, .shading = settings.shading},
                    sweepSettings(of_part, lod), to));
              });
  return stats;
}

GpuRequest LodSplats::gpuRequest(const View& view, const RenderSettings& settings,
                                 const LodSettings& lod) const {
  GpuRequest request = gpuRequestOf(view, settings);
  request.cut = lod.cut;
  request.low_pass_px = lod.low_pass_px;
  if (lod.sub_apertures > 1) request.sub_aperture_centres = subApertureCentres(lod.sub_apertures);
  return request;
}

RenderStats LodSplats::renderLens(const View& view, const RenderSettings& settings,
                                  const LodSettings& lod, Frame& frame) {
  if (gpu_) return statsOf(gpu_->render(gpuRequest(view, settings, lod), frame.gpu));
  const glm::vec2 radius_px_per_D = settings.defocus.radius_px_per_D;
  const bool by_sub_apertures =
      lod.sub_apertures > 1 && radius_px_per_D.x * radius_px_per_D.y > 0.0f;
  return renderSplats(
      view, settings.defocus, lod,
      {.sub_aperture =
           by_sub_apertures ? 1.0f / std::sqrt(static_cast<float>(lod.sub_apertures)) : 0.0f,
       .shading = settings.shading},
      sweepSettings(settings, lod), frame);
}

RenderStats LodSplats::renderSplats(const View& view, const Defocus& defocus,
                                    const LodSettings& lod, Projection projection,
                                    SweepSettings settings, Frame& frame) {
  const glm::vec2 radius_px_per_D = defocus.radius_px_per_D * projection.aperture;
  const bool coarse = radius_px_per_D.x * radius_px_per_D.y > 0.0f ||
                      lod.cut.acuity.base_px > 1.0f || lod.cut.acuity.per_px > 0.0f;
  CutSettings cut = lod.cut;
  cut.margin_px = coarse ? kApron * kMaxStep_px : 0;  // for the aprons of coarse tiles
  settings.defocus = defocus;
  projection.acuity = cut.acuity;
  projection.margin_px = cut.margin_px;
  const auto sweepCut = [&](const View& seen, Frame& to) {
    readSurfelsAhead(tree_->surfels(), cut_);
    projectCut(*tree_, cut_, seen, defocus, projection, chunks_);
    lists_.build(chunks_, seen.size_px, coarse);
    SubApertures sub_apertures{.splats = chunks_.sub_aperture_splats.get(),
                               .out_of_focus_D = chunks_.out_of_focus_D.get(),
                               .out_across_D = chunks_.out_across_D.get(),
                               .centres = {}};
    if (projection.sub_aperture > 0.0f) {
      sub_apertures.centres = subApertureCentres(lod.sub_apertures);
      settings.sub_apertures = &sub_apertures;
    }
    RenderStats stats;
    stats.splats = chunks_.total();
    stats.fragments = sweep(chunks_, lists_, settings, to);
    return stats;
  };
  selectCut(*tree_, view, defocus, cut, cut_);
  if (cut_.size() <= lod.max_splats || view.size_px.x <= kStrip_px) return sweepCut(view, frame);

  RenderStats stats;
  const glm::vec2 gaze_px = cut.acuity.gaze_px;
  for (int x_px = 0; x_px < view.size_px.x; x_px += kStrip_px) {
    View strip = view;
    strip.size_px.x = std::min(kStrip_px, view.size_px.x - x_px);
    strip.principal_px.x -= static_cast<float>(x_px);
    cut.acuity.gaze_px.x = projection.acuity.gaze_px.x = gaze_px.x - static_cast<float>(x_px);
    selectCut(*tree_, strip, defocus, cut, cut_);
    strip_.resize(strip.size_px, settings.depth);
    stats.add(sweepCut(strip, strip_));
    copyColumns(strip_, x_px, frame);
  }
  return stats;
}

}  // namespace foci
