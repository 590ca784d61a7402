#include "render/methods/lod_splats.h"

#include <cmath>

#include "render/methods/lens_samples.h"
#include "render/methods/mean_of_parts.h"
#include "render/methods/view_splats.h"
#include "render/splat/sweep.h"

namespace foci {

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
  meanOfParts(parts, part_, frame, [&](const LensPart& part, Frame& to) {
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
    project(seen, part.defocus, detail.cut,
            {.lens = part.centre, .aperture = part.radius, .shading = settings.shading});
    stats.splats += chunks_.total();
    stats.fragments += sweep(chunks_, lists_,
                             {.background = settings.background,
                              .defocus = part.defocus,
                              .low_pass_px = lod.low_pass_px,
                              .depth = settings.depth},
                             to);
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

void LodSplats::project(const View& view, const Defocus& defocus, const CutSettings& cut,
                        const Projection& projection) {
  const glm::vec2 radius_px_per_D = defocus.radius_px_per_D * projection.aperture;
  const bool coarse = radius_px_per_D.x * radius_px_per_D.y > 0.0f || cut.acuity.base_px > 1.0f ||
                      cut.acuity.per_px > 0.0f;
  const int margin_px = coarse ? kApron * kMaxStep_px : 0;  // for the aprons of coarse tiles
  CutSettings with_margin = cut;
  with_margin.margin_px = margin_px;
  selectCut(*tree_, view, defocus, with_margin, cut_);
  Projection with_acuity = projection;
  with_acuity.acuity = cut.acuity;
  with_acuity.margin_px = margin_px;
  projectCut(*tree_, cut_, view, defocus, with_acuity, chunks_);
  lists_.build(chunks_, view.size_px, coarse);
}

RenderStats LodSplats::renderLens(const View& view, const RenderSettings& settings,
                                  const LodSettings& lod, Frame& frame) {
  if (gpu_) return statsOf(gpu_->render(gpuRequest(view, settings, lod), frame.gpu));
  const glm::vec2 radius_px_per_D = settings.defocus.radius_px_per_D;
  const bool by_sub_apertures =
      lod.sub_apertures > 1 && radius_px_per_D.x * radius_px_per_D.y > 0.0f;
  project(view, settings.defocus, lod.cut,
          {.sub_aperture =
               by_sub_apertures ? 1.0f / std::sqrt(static_cast<float>(lod.sub_apertures)) : 0.0f,
           .shading = settings.shading});
  const SubApertures sub_apertures{.splats = chunks_.sub_aperture_splats.get(),
                                   .out_of_focus_D = chunks_.out_of_focus_D.get(),
                                   .out_across_D = chunks_.out_across_D.get(),
                                   .centres = subApertureCentres(lod.sub_apertures)};
  RenderStats stats;
  stats.splats = chunks_.total();
  stats.fragments = sweep(chunks_, lists_,
                          {.background = settings.background,
                           .defocus = settings.defocus,
                           .low_pass_px = lod.low_pass_px,
                           .depth = settings.depth,
                           .sub_apertures = by_sub_apertures ? &sub_apertures : nullptr},
                          frame);
  return stats;
}

}  // namespace foci
