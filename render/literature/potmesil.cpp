// The first depth of field in computer graphics. A focus processor takes the finished pinhole image
// with depth and spreads each pixel over its circle of confusion. Source: Potmesil and Chakravarty,
// A Lens and Aperture Camera Model for Synthetic Image Generation, SIGGRAPH 1981; Synthetic Image
// Generation with a Lens and Aperture Camera Model, ACM Transactions on Graphics 1(2), 1982. The
// original weighs the light by Lommel's functions. Here it falls evenly on the circle, as Chen
// proposed (Lens Effect on Synthetic Image Generation Based on Light Particle Theory, 1987/88).
// Known failure: each pixel is spread without regard to the others. Blurred light leaks over sharp
// surfaces in front of it. Where surfaces of different blur meet, one side receives too little
// light.
#include "base/parallel.h"
#include "render/methods/method.h"
#include "render/methods/post_filter.h"
#include "render/methods/view_splats.h"

namespace foci {
namespace {

class PotmesilMethod final : public Method {
 public:
  explicit PotmesilMethod(const SurfelCloud& cloud) : camera_(cloud) {}

  RenderStats renderFrame(const View& view, const RenderSettings& settings, Frame& frame) override {
    RenderStats stats = camera_.render(view, settings, frame);
    discs_.set(frame.size_px, frame.rgba, vergences_D(frame, settings.defocus), settings.defocus);
    parallelFor(static_cast<std::size_t>(discs_.tileCount()),
                [&](std::size_t tile) { discs_.spreadOnto(static_cast<int>(tile), frame.rgba); });
    if (!settings.depth) frame.depth_m.clear();
    return stats;
  }

 private:
  PinholeCamera camera_;
  DiscImage discs_;
};

}  // namespace

MethodEntry potmesilMethod() {
  return {.info = {.name = "potmesil",
                   .summary =
                       "each pixel of the pinhole image spread evenly over its circle of confusion",
                   .source = "Potmesil and Chakravarty 1981; Chen 1987",
                   .family = MethodFamily::post_filter,
                   .ellipses = false,
                   .lod = true},
          .make = makeAs<PotmesilMethod>};
}

}  // namespace foci
