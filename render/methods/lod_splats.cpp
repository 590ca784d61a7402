#include "render/methods/lod_splats.h"

#include <algorithm>
#include <cmath>

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
  return {.background = settings.lighting.background,
          .defocus = {},
          .low_pass_px = lod.low_pass_px,
          .depth = settings.depth};
}

bool isBlurred(const RenderSettings& settings) {
  return settings.defocus.radius_px_per_D.x * settings.defocus.radius_px_per_D.y > 0.0f;
}

/// Whether parts of the lens see different images.
bool hasParts(const RenderSettings& settings) {
  return isBlurred(settings) && settings.pupil.hasParts();
}

/// Through the whole aperture, and through sub-apertures if there are several.
Projection projectionFor(int sub_apertures, const RenderSettings& settings) {
  Projection projection{.lighting = settings.lighting};
  if (sub_apertures > 1 && isBlurred(settings)) {
    projection.sub_aperture = 1.0f / std::sqrt(static_cast<float>(sub_apertures));
  }
  return projection;
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
  if (gpu) gpu_ = std::make_unique<GpuSplats>(std::make_shared<GpuScene>(gpu, *tree_));
}

LodSplats::LodSplats(const LodSplats& other, std::nullptr_t) : tree_(other.tree_) {
  if (other.gpu_) gpu_ = std::make_unique<GpuSplats>(other.gpu_->scene());
}

RenderStats LodSplats::render(const View& view, const RenderSettings& settings,
                              const LodSettings& lod, Frame& frame) {
  if (lod.sharp && isBlurred(settings)) {
    RenderSettings sharp = settings;
    sharp.defocus.radius_px_per_D = glm::vec2(0.0f);
    return render(view, sharp, lod, frame);
  }
  if (hasParts(settings) || (!lod.parts.empty() && isBlurred(settings))) {
    return renderParts(view, settings, lod, frame);
  }
  LodSettings softened = lod;
  softened.cut.acuity = widened(lod.cut.acuity, settings.pupil);
  return renderLens(view, settings, softened, frame);
}

RenderStats LodSplats::renderParts(const View& view, const RenderSettings& settings,
                                   const LodSettings& lod, Frame& frame) {
  RenderStats stats;
  const bool given = !lod.parts.empty();
  meanOfParts(given ? lod.parts : partsFor(settings.defocus, settings.pupil, lod.sub_apertures),
              given ? 0.0f : settings.pupil.diffraction_px, part_, frame,
              [&](const LensPart& part, Frame& to) {
                stats.add(renderPart(view, settings, lod, part, to));
              });
  return stats;
}

RenderStats LodSplats::renderPart(const View& view, const RenderSettings& settings,
                                  const LodSettings& lod, const LensPart& part, Frame& frame) {
  const View seen = viewOfPart(view, part);
  RenderSettings of_part = settings;
  of_part.defocus = part.defocus;
  LodSettings detail = lod;
  detail.cut.acuity =
      lod.parts.empty() ? widened(lod.cut.acuity, part) : widened(lod.cut.acuity, settings.pupil);
  detail.cut.per_blur2 *= part.radius * part.radius;
  detail.sub_apertures = 1;
  if (gpu_) {
    GpuRequest request = gpuRequest(seen, of_part, detail);
    request.lens = part.centre;
    request.aperture = part.radius;
    return statsOf(gpu_->render(request, frame.gpu));
  }
  return renderSplats(
      binnedOf(seen, part.defocus, detail.cut,
               {.lens = part.centre, .aperture = part.radius, .lighting = settings.lighting}),
      detail, sweepSettings(of_part, lod), frame);
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
  const Projection projection = projectionFor(lod.sub_apertures, settings);
  return renderSplats(binnedOf(view, settings.defocus, lod.cut, projection), lod,
                      sweepSettings(settings, lod), frame);
}

LodSplats::Binned LodSplats::binnedOf(const View& view, const Defocus& defocus,
                                      const CutSettings& cut, Projection projection) {
  const glm::vec2 radius_px_per_D = defocus.radius_px_per_D * projection.aperture;
  const bool coarse = radius_px_per_D.x * radius_px_per_D.y > 0.0f || cut.acuity.base_px > 1.0f ||
                      cut.acuity.per_px > 0.0f;
  Binned of{view, defocus, cut, projection};
  // For the aprons of coarse tiles.
  of.cut.margin_px = of.projection.margin_px = coarse ? kApron * kMaxStep_px : 0;
  of.projection.acuity = cut.acuity;
  return of;
}

void LodSplats::binCut(const Binned& wanted) {
  readSurfelsAhead(tree_->surfels(), cut_);
  projectCut(*tree_, cut_, wanted.view, wanted.defocus, wanted.projection, chunks_);
  lists_.build(chunks_, wanted.view.size_px, wanted.coarse());
}

std::uint64_t LodSplats::sweepTiles(const Binned& of, const LodSettings& lod,
                                    SweepSettings settings, Frame& frame) {
  settings.defocus = of.defocus;
  settings.principal_px = of.view.principal_px;
  SubApertures sub_apertures{.splats = chunks_.sub_aperture_splats.get(),
                             .out_of_focus_D = chunks_.out_of_focus_D.get(),
                             .out_across_D = chunks_.out_across_D.get(),
                             .lens_px = chunks_.lens_px.get(),
                             .centres = {}};
  if (of.projection.sub_aperture > 0.0f && lod.sub_apertures > 1) {
    sub_apertures.centres = subApertureCentres(lod.sub_apertures);
    settings.sub_apertures = &sub_apertures;
  }
  return sweep(chunks_, lists_, settings, frame);
}

RenderStats LodSplats::renderSplats(const Binned& of, const LodSettings& lod,
                                    const SweepSettings& settings, Frame& frame) {
  RenderStats stats;
  selectCut(*tree_, of.view, of.defocus, of.cut, cut_);
  if (cut_.size() <= lod.max_splats || of.view.size_px.x <= kStrip_px) {
    binCut(of);
    stats.splats = chunks_.total();
    stats.fragments = sweepTiles(of, lod, settings, frame);
    return stats;
  }

  for (int x_px = 0; x_px < of.view.size_px.x; x_px += kStrip_px) {
    Binned strip = of;
    strip.view.size_px.x = std::min(kStrip_px, of.view.size_px.x - x_px);
    strip.view.principal_px.x -= static_cast<float>(x_px);
    strip.cut.acuity.gaze_px.x -= static_cast<float>(x_px);
    strip.projection.acuity = strip.cut.acuity;
    selectCut(*tree_, strip.view, of.defocus, strip.cut, cut_);
    binCut(strip);
    strip_.resize(strip.view.size_px, settings.depth);
    stats.splats += chunks_.total();
    stats.fragments += sweepTiles(strip, lod, settings, strip_);
    copyColumns(strip_, x_px, frame);
  }
  return stats;
}

}  // namespace foci
