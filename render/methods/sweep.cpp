// Our renderer: EWA surface splatting with the blur of each splat (Krivanek, Zara and Bouatouch
// 2003), streamed over tiles without lists of fragments. Known failure: one layer a pixel is open
// at a time, so surfaces nearer to each other than a surfel is wide join; and of what blurred
// layers in front hide, one straight edge on the lens is remembered, where there may be several.
#include "render/methods/method.h"
#include "render/methods/view_splats.h"

namespace foci {
namespace {

class SweepMethod final : public Method {
 public:
  explicit SweepMethod(const SurfelCloud& cloud) : cloud_(cloud) {}

  RenderStats renderFrame(const View& view, const RenderSettings& settings, Frame& frame) override {
    scene_.project(cloud_, view, settings, {});
    RenderStats stats;
    stats.splats = scene_.count();
    stats.fragments = scene_.render(settings.background, settings.depth, frame);
    return stats;
  }

 private:
  const SurfelCloud& cloud_;
  ViewSplats scene_;
};

}  // namespace

MethodEntry sweepMethod() {
  return {
      .info =
          {.name = "sweep",
           .summary =
               "each splat blurred before the image is formed; streamed over tiles, without lists",
           .source = "Krivanek, Zara and Bouatouch 2003, and our own"},
      .make = makeAs<SweepMethod>};
}

}  // namespace foci
