// No depth of field: one view through the middle of the lens. This is the traditional camera of
// computer graphics, which Potmesil and Chakravarty (A Lens and Aperture Camera Model for Synthetic
// Image Generation, 1981) extended. The post-filters of this folder start from its image. Known
// failure: everything is sharp, wherever the focus is.
#include "render/methods/gaussian_methods.h"
#include "render/methods/method.h"
#include "render/methods/view_splats.h"

namespace foci {
namespace {

class PinholeMethod final : public Method {
 public:
  PinholeMethod(const SurfelCloud& cloud, const SharedGpu& gpu)
      : sweep_(makeMethod("sweep", cloud, gpu)) {}

  RenderStats renderFrame(const View& view, const RenderSettings& settings, Frame& frame) override {
    return sweep_->renderKept(view, withoutBlur(settings), frame);
  }

 private:
  std::unique_ptr<Method> sweep_;
};

}  // namespace

MethodEntry pinholeMethod() {
  return {.info = {.name = "pinhole",
                   .summary = "no depth of field",
                   .source = "the traditional camera",
                   .family = MethodFamily::post_filter,
                   .gpu = true,
                   .lod = true},
          .make = makeAs<PinholeMethod>,
          .make_of_gaussians = gaussianPinhole};
}

}  // namespace foci
