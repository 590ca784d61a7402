// Our renderer, modelling no more than shows: what is blurred is rendered from coarser levels of
// detail and at fewer samples, and the lens is taken apart only where surfaces cover each other in
// part. Known failure: surfaces that the lens sees between and around in many places at once
// (foliage) want more parts than are rendered; where two of them lie closer together than a node is
// wide, they join.
#include "render/methods/lod_splats.h"
#include "render/methods/method.h"

namespace foci {
namespace {

class SweepLodMethod final : public Method {
 public:
  SweepLodMethod(const SurfelCloud& cloud, int parts) : scene_(cloud), parts_(parts) {}

  RenderStats renderFrame(const View& view, const RenderSettings& settings, Frame& frame) override {
    return scene_.render(view, settings, {.cut = kFaithfulCut, .sub_apertures = parts_}, frame);
  }

 private:
  LodSplats scene_;
  int parts_;
};

}  // namespace

MethodEntry sweepLodMethod() {
  return {
      .info = {.name = "sweep-lod",
               .summary =
                   "sweep from coarser levels and fewer samples where blurred; N parts of the lens "
                   "where surfaces overlap",
               .source = "our own",
               .most = 256,
               .standard = 7},
      .make = makeAs<SweepLodMethod>};
}

}  // namespace foci
