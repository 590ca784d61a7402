#include "render/methods/lod_splats.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
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

bool isBlurred(const RenderSettings& settings) {
  return settings.defocus.radius_px_per_D.x * settings.defocus.radius_px_per_D.y > 0.0f;
}

/// Whether parts of the lens see different images.
bool hasParts(const RenderSettings& settings) {
  return isBlurred(settings) && settings.pupil.hasParts();
}

/// Through the whole aperture, and through sub-apertures if there are several.
Projection projectionFor(int sub_apertures, const RenderSettings& settings) {
  Projection projection{.shading = settings.shading};
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
  if (gpu) gpu_.emplace(std::make_shared<GpuScene>(gpu, *tree_));
}

LodSplats::LodSplats(const LodSplats& other, std::nullptr_t) : tree_(other.tree_) {
  if (other.gpu_) gpu_.emplace(other.gpu_->scene());
}

RenderStats LodSplats::render(const View& view, const RenderSettings& settings,
                              const LodSettings& lod, Frame& frame) {
  if (hasParts(settings)) return renderParts(view, settings, lod, frame);
  LodSettings softened = lod;
  softened.cut.acuity = widened(lod.cut.acuity, settings.pupil);
  return renderLens(view, settings, softened, frame);
}

RenderStats LodSplats::renderParts(const View& view, const RenderSettings& settings,
                                   const LodSettings& lod, Frame& frame) {
  const std::vector<LensPart> parts = partsFor(settings.defocus, settings.pupil, lod.sub_apertures);
  RenderStats stats;
  meanOfParts(
      parts, settings.pupil.diffraction_px, part_, frame, [&](const LensPart& part, Frame& to) {
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
            binnedOf(seen, part.defocus, detail.cut,
                     {.lens = part.centre, .aperture = part.radius, .shading = settings.shading}),
            detail, sweepSettings(of_part, lod), to));
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
  const Projection projection = projectionFor(lod.sub_apertures, settings);
  return renderSplats(binnedOf(view, settings.defocus, lod.cut, projection), lod,
                      sweepSettings(settings, lod), frame);
}

bool LodSplats::renderWindows(const View& view, const RenderSettings& settings,
                              const LodSettings& lod, std::span<const Window> windows,
                              Frame& frame) {
  if (gpu_ || hasParts(settings)) return false;
  CutSettings cut = lod.cut;
  cut.acuity = widened(cut.acuity, settings.pupil);
  const Binned wanted =
      binnedOf(view, settings.defocus, cut, projectionFor(lod.sub_apertures, settings));
  if (!bin(wanted, lod.max_splats)) return false;
  if (!begun_) begun_ = {.of = wanted, .by = {}, .rendered = {}};
  goOn(lod, sweepSettings(settings, lod), lists_.tilesMeeting(windows), frame);
  return true;
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

bool LodSplats::bin(const Binned& wanted, std::size_t max_splats) {
  if (begun_) {
    // Splats for sub-apertures, if any, are beside the others.
    const float sub_aperture = wanted.projection.sub_aperture;
    Binned there = begun_->of;
    there.projection.sub_aperture = sub_aperture;
    if (there == wanted) {
      if (sub_aperture > 0.0f && begun_->of.projection.sub_aperture != sub_aperture) {
        projectCut(*tree_, cut_, wanted.view, wanted.defocus, wanted.projection, chunks_);
        begun_->of = wanted;
      }
      return true;
    }
  }
  begun_.reset();
  selectCut(*tree_, wanted.view, wanted.defocus, wanted.cut, cut_);
  if (cut_.size() > max_splats && wanted.view.size_px.x > kStrip_px) return false;
  binCut(wanted);
  return true;
}

void LodSplats::binCut(const Binned& wanted) {
  readSurfelsAhead(tree_->surfels(), cut_);
  projectCut(*tree_, cut_, wanted.view, wanted.defocus, wanted.projection, chunks_);
  lists_.build(chunks_, wanted.view.size_px, wanted.coarse());
}

void LodSplats::goOn(const LodSettings& lod, const SweepSettings& settings,
                     std::vector<std::uint32_t> tiles, Frame& frame) {
  const Swept by{lod.sub_apertures, settings.background, settings.low_pass_px, settings.depth,
                 &frame};
  std::vector<std::uint8_t>& rendered = begun_->rendered;
  if (begun_->by != by || rendered.size() != lists_.tiles().size()) {
    begun_->by = by;
    begun_->fragments = 0;
    rendered.assign(lists_.tiles().size(), 0);
  }
  std::erase_if(tiles, [&](std::uint32_t tile) { return rendered[tile] != 0; });
  for (const std::uint32_t tile : tiles) rendered[tile] = 1;
  begun_->fragments += sweepTiles(begun_->of, lod, settings, &tiles, frame);
}

std::uint64_t LodSplats::sweepTiles(const Binned& of, const LodSettings& lod,
                                    SweepSettings settings, const std::vector<std::uint32_t>* tiles,
                                    Frame& frame) {
  settings.defocus = of.defocus;
  settings.tiles = tiles;
  SubApertures sub_apertures{.splats = chunks_.sub_aperture_splats.get(),
                             .out_of_focus_D = chunks_.out_of_focus_D.get(),
                             .out_across_D = chunks_.out_across_D.get(),
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
  if (bin(of, lod.max_splats)) {
    stats.splats = chunks_.total();
    if (!begun_) {
      stats.fragments = sweepTiles(of, lod, settings, nullptr, frame);
      return stats;
    }
    std::vector<std::uint32_t> all(lists_.tiles().size());
    std::iota(all.begin(), all.end(), 0u);
    goOn(lod, settings, std::move(all), frame);
    stats.fragments = begun_->fragments;
    begun_.reset();
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
    stats.fragments += sweepTiles(strip, lod, settings, nullptr, strip_);
    copyColumns(strip_, x_px, frame);
  }
  return stats;
}

}  // namespace foci
