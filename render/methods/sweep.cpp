// Our renderer without level of detail for blur: EWA surface splatting that blurs each splat before
// the image is formed (Krivanek, Zara and Bouatouch, Fast Depth of Field Rendering with Surface
// Splatting, 2003). Only surfels much finer than a pixel are merged. It streams the splats over
// tiles and keeps no lists of fragments. Known failure: each pixel has one open layer at a time, so
// surfaces closer together than the width of a surfel join. Blurred layers in front cover the lens
// up to one straight edge, although several of them can leave a more complex shape open.
#include <algorithm>
#include <cmath>
#include <optional>

#include "render/gl/splats.h"
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
      : cloud_(cloud), parts_(std::max(sub_apertures, 1)), gpu_(gpuSplatsOf(cloud, gpu)) {}

  RenderStats renderFrame(const View& view, const RenderSettings& settings, Frame& frame) override {
    RenderStats stats;
    meanOfParts(lensParts(settings.defocus, settings.pupil, parts_), settings.pupil.diffraction_px,
                part_, frame, [&](const LensPart& part, Frame& to) {
                  renderPart(part, view, settings, to, stats);
                });
    return stats;
  }

 private:
  void renderPart(const LensPart& part, const View& view, const RenderSettings& settings,
                  Frame& frame, RenderStats& stats) {
    RenderSettings of_part = settings;
    of_part.defocus = part.defocus;
    const View seen = viewOfPart(view, part);
    const Acuity acuity = widened({}, part);
    if (gpu_) {
      GpuRequest request = gpuRequestOf(seen, of_part);
      request.lens = part.centre;
      request.aperture = part.radius;
      request.acuity = acuity;
      request.cut = pixelCutOf(cloud_, acuity);
      stats.add(statsOf(gpu_->render(request, frame.gpu)));
      return;
    }
    scene_.project(cloud_, seen, of_part,
                   {.lens = part.centre, .aperture = part.radius, .acuity = acuity},
                   pixelCutOf(cloud_, acuity));
    stats.splats += scene_.count();
    stats.fragments += scene_.render(settings.background, settings.depth, frame);
  }

  const SurfelCloud& cloud_;
  int parts_;
  std::optional<GpuSplats> gpu_;
  ViewSplats scene_;
  Frame part_;
};

}  // namespace

MethodEntry sweepMethod() {
  return {.info = {.name = "sweep",
                   .summary = "each splat blurred before the image is formed; N: the mean of N "
                              "sub-apertures",
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
