// Our renderer with level of detail. It renders blurred surfaces from coarser LOD nodes and at
// fewer samples. Where surfaces cover each other in part, it renders N sub-apertures instead of one
// whole-aperture pass. Source: our own. Known failure: foliage needs more sub-apertures than
// N, because the lens sees between and around surfaces in many places at once. Two surfaces closer
// together than the width of a node join.
#include "render/methods/gaussian_methods.h"
#include "render/methods/lod_splats.h"
#include "render/methods/method.h"

namespace foci {
namespace {

class SweepLodMethod final : public Method {
 public:
  SweepLodMethod(const SurfelCloud& cloud, int sub_apertures, const SharedGpu& gpu)
      : scene_(cloud, gpu), sub_apertures_(sub_apertures) {}

  RenderStats renderFrame(const View& view, const RenderSettings& settings, Frame& frame) override {
    return scene_.render(view, settings, {.cut = kFaithfulCut, .sub_apertures = sub_apertures_},
                         frame);
  }

 private:
  LodSplats scene_;
  int sub_apertures_;
};

}  // namespace

MethodEntry sweepLodMethod() {
  return {.info = {.name = "sweep-lod",
                   .summary = "sweep from coarser nodes and fewer samples where blurred; N "
                              "sub-apertures where surfaces overlap",
                   .source = "our own",
                   .family = MethodFamily::own,
                   .max_n = 256,
                   .default_n = 7,
                   .aberrations = true,
                   .gpu = true,
                   .lod = true},
          .make = makeAs<SweepLodMethod>,
          .make_of_gaussians = gaussianSweepLod};
}

}  // namespace foci
