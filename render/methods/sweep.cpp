// Our renderer without level of detail: EWA surface splatting that blurs each splat before the
// image is formed (Krivanek, Zara and Bouatouch, Fast Depth of Field Rendering with Surface
// Splatting, 2003). It streams the splats over tiles and keeps no lists of fragments. Known
// failure: each pixel has one open layer at a time, so surfaces closer together than the width of a
// surfel join. Blurred layers in front cover the lens up to one straight edge, although several of
// them can leave a more complex shape open.
#include <algorithm>
#include <cmath>
#include <optional>

#include "base/parallel.h"
#include "render/gl/splats.h"
#include "render/methods/gaussian_methods.h"
#include "render/methods/lens_samples.h"
#include "render/methods/method.h"
#include "render/methods/view_splats.h"

namespace foci {
namespace {

class SweepMethod final : public Method {
 public:
  /// @param sub_apertures  0 and 1: the whole aperture
  SweepMethod(const SurfelCloud& cloud, int sub_apertures, const SharedGpu& gpu)
      : cloud_(cloud), centres_(subApertureCentres(std::max(sub_apertures, 1))) {
    if (gpu) gpu_.emplace(std::make_shared<GpuScene>(gpu, cloud));
  }

  RenderStats renderFrame(const View& view, const RenderSettings& settings, Frame& frame) override {
    RenderStats stats;
    if (centres_.size() == 1) {
      renderPart({}, view, settings, frame, stats);
      return stats;
    }
    const float share = 1.0f / static_cast<float>(centres_.size());
    part_.resize(view.size_px, settings.depth);
    for (std::size_t i = 0; i < centres_.size(); ++i) {
      renderPart({.lens = centres_[i], .aperture = std::sqrt(share)}, view, settings, part_, stats);
      parallelFor(frame.rgba.size(), [&](std::size_t p) {
        const float coverage = part_.rgba[p].a;
        frame.rgba[p] = (i == 0 ? glm::vec4(0.0f) : frame.rgba[p]) + share * part_.rgba[p];
        if (!settings.depth) return;
        frame.depth_m[p] = (i == 0 ? 0.0f : frame.depth_m[p]) + share * coverage * part_.depth_m[p];
      });
    }
    for (std::size_t p = 0; settings.depth && p < frame.rgba.size(); ++p) {
      if (frame.rgba[p].a > 0.0f) frame.depth_m[p] /= frame.rgba[p].a;
    }
    return stats;
  }

 private:
  void renderPart(const Projection& part, const View& view, const RenderSettings& settings,
                  Frame& frame, RenderStats& stats) {
    if (gpu_) {
      GpuRequest request = gpuRequestOf(view, settings);
      request.lens = part.lens;
      request.aperture = part.aperture;
      stats.add(statsOf(gpu_->render(request, frame)));
      return;
    }
    scene_.project(cloud_, view, settings, part);
    stats.splats += scene_.count();
    stats.fragments += scene_.render(settings.background, settings.depth, frame);
  }

  const SurfelCloud& cloud_;
  std::vector<glm::vec2> centres_;
  ViewSplats scene_;
  std::optional<GpuSplats> gpu_;
  Frame part_;
};

}  // namespace

MethodEntry sweepMethod() {
  return {.info = {.name = "sweep",
                   .summary = "each splat blurred before the image is formed; N: the mean of N "
                              "sub-apertures",
                   .source = "Krivanek, Zara and Bouatouch 2003, and our own",
                   .max_n = 100,
                   .gpu = true},
          .make = makeAs<SweepMethod>,
          .make_of_gaussians = gaussianSweep};
}

}  // namespace foci
