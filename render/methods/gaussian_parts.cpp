#include "render/methods/gaussian_parts.h"

#include "render/methods/gaussian_methods.h"
#include "render/methods/mean_of_parts.h"

namespace foci {

RenderStats GaussianParts::render(LensGaussians& scene, const std::vector<LensPart>& parts,
                                  const View& view, const RenderSettings& settings,
                                  const GaussianCutSettings* lod, Frame& frame) {
  const float share = partDiscRadius(parts.size());
  RenderStats stats;
  meanOfParts(parts, 0.0f, part_, frame, [&](const LensPart& part, Frame& to) {
    const std::vector<LensDisc> disc = {{part.centre, share * part.radius}};
    stats.add(scene.project(viewOfPart(view, part), part.defocus, disc, lod));
    stats.add(scene.render(disc, settings.background, to));
  });
  return stats;
}

}  // namespace foci
