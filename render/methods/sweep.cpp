// Our renderer without level of detail: EWA surface splatting that blurs each splat before the
// image is formed (Krivanek, Zara and Bouatouch, Fast Depth of Field Rendering with Surface
// Splatting, 2003). It streams the splats over tiles and keeps no lists of fragments. Known
// failure: each pixel has one open layer at a time, so surfaces closer together than the width of a
// surfel join. Blurred layers in front cover the lens up to one straight edge, although several of
// them can leave a more complex shape open.
#include <optional>

#include "render/gl/splats.h"
#include "render/methods/method.h"
#include "render/methods/view_splats.h"

namespace foci {
namespace {

class SweepMethod final : public Method {
 public:
  SweepMethod(const SurfelCloud& cloud, const SharedGpu& gpu) : cloud_(cloud) {
    if (gpu) gpu_.emplace(std::make_shared<GpuScene>(gpu, cloud));
  }

  RenderStats renderFrame(const View& view, const RenderSettings& settings, Frame& frame) override {
    if (gpu_) return statsOf(gpu_->render(gpuRequestOf(view, settings), frame));
    scene_.project(cloud_, view, settings, {});
    RenderStats stats;
    stats.splats = scene_.count();
    stats.fragments = scene_.render(settings.background, settings.depth, frame);
    return stats;
  }

 private:
  const SurfelCloud& cloud_;
  ViewSplats scene_;
  std::optional<GpuSplats> gpu_;
};

}  // namespace

MethodEntry sweepMethod() {
  return {
      .info =
          {.name = "sweep",
           .summary =
               "each splat blurred before the image is formed; streamed over tiles, without lists",
           .source = "Krivanek, Zara and Bouatouch 2003, and our own",
           .gpu = true},
      .make = makeAs<SweepMethod>};
}

}  // namespace foci
