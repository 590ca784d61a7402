// No depth of field: one view through the middle of the lens. This is the traditional camera of
// computer graphics, which Potmesil and Chakravarty (A Lens and Aperture Camera Model for Synthetic
// Image Generation, 1981) extended. The post-filters of this folder start from its image. Known
// failure: everything is sharp, wherever the focus is.
#include "render/methods/method.h"
#include "render/methods/view_splats.h"

namespace foci {
namespace {

class PinholeMethod final : public Method {
 public:
  PinholeMethod(const SurfelCloud& cloud, const SharedGpu& gpu) : camera_(cloud, gpu) {}

  RenderStats renderFrame(const View& view, const RenderSettings& settings, Frame& frame) override {
    RenderStats stats = camera_.render(view, settings, frame);
    if (!settings.depth) frame.depth_m.clear();
    return stats;
  }

 private:
  PinholeCamera camera_;
};

}  // namespace

MethodEntry pinholeMethod() {
  return {.info = {.name = "pinhole",
                   .summary = "no depth of field",
                   .source = "the traditional camera",
                   .gpu = true},
          .make = makeAs<PinholeMethod>};
}

}  // namespace foci
