#include "render/methods/lod_splats.h"

#include <cmath>

#include "render/methods/lens_samples.h"
#include "render/methods/view_splats.h"
#include "render/splat/project.h"
#include "render/splat/sweep.h"

namespace foci {

LodSplats::LodSplats(const SurfelCloud& cloud, const SharedGpu& gpu)
    : tree_(std::make_shared<MomentTree>(cloud)) {
  if (gpu) gpu_.emplace(std::make_shared<GpuScene>(gpu, *tree_));
}

LodSplats::LodSplats(const LodSplats& other, std::nullptr_t) : tree_(other.tree_) {
  if (other.gpu_) gpu_.emplace(other.gpu_->scene());
}

RenderStats LodSplats::renderOnGpu(const View& view, const RenderSettings& settings,
                                   const LodSettings& lod, Frame& frame) {
  GpuRequest request = gpuRequestOf(view, settings);
  request.cut = lod.cut;
  request.low_pass_px = lod.low_pass_px;
  if (lod.sub_apertures > 1) request.sub_aperture_centres = subApertureCentres(lod.sub_apertures);
  return statsOf(gpu_->render(request, frame));
}

RenderStats LodSplats::render(const View& view, const RenderSettings& settings,
                              const LodSettings& lod, Frame& frame) {
  if (gpu_) return renderOnGpu(view, settings, lod, frame);
  const glm::vec2 radius_px_per_D = settings.defocus.radius_px_per_D;
  const Acuity& acuity = lod.cut.acuity;
  const bool blurred = radius_px_per_D.x * radius_px_per_D.y > 0.0f;
  const bool coarse = blurred || acuity.base_px > 1.0f || acuity.per_px > 0.0f;
  const bool by_sub_apertures = lod.sub_apertures > 1 && blurred;
  const int margin_px = coarse ? kApron * kMaxStep_px : 0;  // for the aprons of coarse tiles
  CutSettings cut = lod.cut;
  cut.margin_px = margin_px;
  selectCut(*tree_, view, settings.defocus, cut, cut_);
  projectCut(*tree_, cut_, view, settings.defocus,
             {.sub_aperture =
                  by_sub_apertures ? 1.0f / std::sqrt(static_cast<float>(lod.sub_apertures)) : 0.0f,
              .acuity = acuity,
              .margin_px = margin_px,
              .shading = settings.shading},
             chunks_);
  lists_.build(chunks_, view.size_px, coarse);
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
