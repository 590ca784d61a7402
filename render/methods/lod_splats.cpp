#include "render/methods/lod_splats.h"

#include <cmath>

#include "render/methods/lens_samples.h"
#include "render/splat/project.h"
#include "render/splat/sweep.h"

namespace foci {

RenderStats LodSplats::render(const View& view, const RenderSettings& settings,
                              const LodSettings& lod, Frame& frame) {
  const glm::vec2 radius_px_per_D = settings.defocus.radius_px_per_D;
  const Acuity& acuity = lod.cut.acuity;
  const bool blurred = radius_px_per_D.x * radius_px_per_D.y > 0.0f;
  const bool coarse = blurred || acuity.base_px > 1.0f || acuity.per_px > 0.0f;
  const bool by_sub_apertures = lod.sub_apertures > 1 && blurred;
  selectCut(*tree_, view, settings.defocus, lod.cut, cut_);
  projectCut(*tree_, cut_, view, settings.defocus,
             {.sub_aperture =
                  by_sub_apertures ? 1.0f / std::sqrt(static_cast<float>(lod.sub_apertures)) : 0.0f,
              .acuity = acuity,
              .margin_px = coarse ? kApron * kMaxStep_px : 0,  // for the aprons of coarse tiles
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
