// Our renderer, modelling no more than shows: what is blurred is drawn from coarser levels of
// detail and at fewer samples, and the lens is taken apart only where surfaces cover each other in
// part. Known failure: surfaces that the lens sees between and around in many places at once
// (foliage) want more parts than are drawn; where two of them lie closer together than a node is
// wide, they join.
#include <cmath>

#include "render/lod/cut.h"
#include "render/methods/lens_samples.h"
#include "render/methods/method.h"
#include "render/splat/bin.h"
#include "render/splat/project.h"
#include "render/splat/sweep.h"

namespace foci {
namespace {

/// What merging adds to the variance stays within 3 % of the blur's and the pixel's own: a node is
/// at most about a quarter of the blur's radius wide (a square's spread is side^2 / 12), 0.6 px in
/// focus.
constexpr CutSettings kCut{.per_blur2 = 0.006f, .per_pixel2 = 0.03f};

class SweepLodMethod final : public Method {
 public:
  SweepLodMethod(const SurfelCloud& cloud, int parts) : tree_(cloud), centres_(lensParts(parts)) {}

  RenderStats draw(const View& view, const RenderSettings& settings, Frame& frame) override {
    const glm::vec2 radius_px_per_D = settings.defocus.radius_px_per_D;
    const bool blurred = radius_px_per_D.x * radius_px_per_D.y > 0.0f;
    const bool in_parts = centres_.size() > 1 && blurred;
    selectCut(tree_, view, settings.defocus, kCut, cut_);
    projectCut(
        tree_, cut_, view, settings.defocus,
        {.part_aperture = in_parts ? 1.0f / std::sqrt(static_cast<float>(centres_.size())) : 0.0f,
         .margin_px = kApron * kMostStep_px,
         .shading = settings.shading},
        chunks_);
    lists_.build(chunks_, view.size_px, blurred);
    const LensParts parts{.splats = chunks_.parts.get(),
                          .lens = chunks_.part_lens.get(),
                          .out_of_focus_D = chunks_.out_of_focus_D.get(),
                          .centres = centres_};
    RenderStats stats;
    stats.splats = chunks_.total();
    stats.fragments = sweep(chunks_, lists_,
                            {.background = settings.background,
                             .radius_px_per_D = radius_px_per_D,
                             .transparent = !tree_.surfels().opacity.empty(),
                             .depth = settings.depth,
                             .parts = in_parts ? &parts : nullptr},
                            frame);
    return stats;
  }

 private:
  MomentTree tree_;
  std::vector<glm::vec2> centres_;
  Cut cut_;
  SplatChunks chunks_;
  TileLists lists_;
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
      .make = [](const SurfelCloud& cloud, int parts) -> std::unique_ptr<Method> {
        return std::make_unique<SweepLodMethod>(cloud, parts);
      }};
}

}  // namespace foci
