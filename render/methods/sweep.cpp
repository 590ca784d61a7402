// Our renderer without level of detail for blur: EWA surface splatting that blurs each splat before
// the image is formed (Krivanek, Zara and Bouatouch, Fast Depth of Field Rendering with Surface
// Splatting, 2003). Only surfels much finer than a pixel are merged. It streams the splats over
// tiles and keeps no lists of fragments. Known failure: each pixel has one open layer at a time, so
// surfaces closer together than the width of a surfel join. Blurred layers in front cover the lens
// up to one straight edge, although several of them can leave a more complex shape open.
#include <algorithm>

#include "render/methods/gaussian_methods.h"
#include "render/methods/mean_of_parts.h"
#include "render/methods/method.h"
#include "render/methods/view_splats.h"

namespace foci {
namespace {

class SweepMethod final : public Method {
 public:
  /// @param sub_apertures  0 and 1: the whole aperture
  SweepMethod(const SurfelCloud& cloud, int sub_apertures, const SharedGpu& gpu)
      : scene_(cloud, gpu), parts_(std::max(sub_apertures, 1)) {}

  RenderStats renderFrame(const View& view, const RenderSettings& settings, Frame& frame) override {
    RenderStats stats;
    meanOfParts(lensParts(settings.defocus, settings.pupil, parts_), settings.pupil.diffraction_px,
                part_, frame, [&](const LensPart& part, Frame& to) {
                  scene_.render(view, settings, part, widened({}, part), to, stats);
                });
    return stats;
  }

 private:
  PartSplats scene_;
  int parts_;
  Frame part_;
};

}  // namespace

MethodEntry sweepMethod() {
  return {
      .info = {.name = "sweep",
               .summary =
                   "each splat blurred before the image is formed; N: the mean of N sub-apertures",
               .source = "Krivanek, Zara and Bouatouch 2003, and our own",
               .family = MethodFamily::own,
               .max_n = 100,
               .aberrations = true,
               .gpu = true,
               .lod = true},
      .make = makeAs<SweepMethod>,
      .make_of_gaussians = gaussianSweep};
}

}  // namespace foci
