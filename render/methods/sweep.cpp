// Our renderer: EWA surface splatting with the blur of each splat (Krivanek, Zara and Bouatouch
// 2003), streamed over tiles without lists of fragments. Known failure: one layer a pixel is open
// at a time, so surfaces nearer to each other than a surfel is wide join, and what a blurred
// foreground hides from parts of the lens only is taken as hidden alike from all of it.
#include <chrono>

#include "render/methods/method.h"
#include "render/splat/bin.h"
#include "render/splat/project.h"
#include "render/splat/sweep.h"

namespace foci {
namespace {

class SweepMethod final : public Method {
 public:
  explicit SweepMethod(const SurfelCloud& cloud) : cloud_(cloud) {}

  RenderStats render(const View& view, const RenderSettings& settings, Frame& frame) override {
    const auto start = std::chrono::steady_clock::now();
    const std::size_t pixels = static_cast<std::size_t>(view.size_px.x) * view.size_px.y;
    frame.size_px = view.size_px;
    frame.rgba.resize(pixels);
    frame.depth_m.resize(settings.depth ? pixels : 0);

    projectSurfels(cloud_, view, settings.defocus, {.shading = settings.shading}, chunks_);
    lists_.build(chunks_, view.size_px);
    RenderStats stats;
    stats.splats = chunks_.total();
    stats.fragments = sweep(chunks_, lists_,
                            {.background = settings.background,
                             .radius_px_per_D = settings.defocus.radius_px_per_D,
                             .transparent = !cloud_.opacity.empty(),
                             .depth = settings.depth},
                            frame);
    stats.ms =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    return stats;
  }

 private:
  const SurfelCloud& cloud_;
  SplatChunks chunks_;
  TileLists lists_;
};

}  // namespace

std::unique_ptr<Method> makeSweep(const SurfelCloud& cloud) {
  return std::make_unique<SweepMethod>(cloud);
}

}  // namespace foci
