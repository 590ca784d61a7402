// The published baseline without level of detail: Krivanek, Zara and Bouatouch, Fast Depth of Field
// Rendering with Surface Splatting (2003). Every splat is blurred by its own circle of confusion
// (Eq. 11) and becomes a truncated Gaussian. The splats go to an A-buffer with z-ranges
// (section 6.4). Known failure, which the paper states: the z-range is that of the blurred splat.
// So surfaces that are close together, or that cross, merge where one should hide the other. The
// cost grows with the square of the blur.
#include "render/literature/paper.h"

#include <algorithm>

#include "base/parallel.h"
#include "render/literature/paper/project.h"
#include "render/splat/splat.h"

namespace foci {
namespace {

class PaperMethod final : public Method {
 public:
  explicit PaperMethod(const SurfelCloud& cloud) : cloud_(cloud) {}

  RenderStats renderFrame(const View& view, const RenderSettings& settings, Frame& frame) override {
    const std::size_t n = cloud_.size();
    const std::size_t chunk = chunkSize(n);
    splats_.reserve(n);
    splats_.chunks.assign((n + chunk - 1) / chunk, {});
    parallelFor(splats_.chunks.size(), [&](std::size_t c) {
      const std::size_t begin = c * chunk;
      splats_.chunks[c].begin = begin;
      splats_.chunks[c].count =
          projectPaper({.count = std::min(n - begin, chunk),
                        .position_m = cloud_.position_m.data() + begin,
                        .axis_u_m = cloud_.axis_u_m.data() + begin,
                        .axis_v_m = cloud_.axis_v_m.data() + begin,
                        .color = cloud_.color.data() + begin,
                        .opacity = cloud_.opacity.empty() ? nullptr : cloud_.opacity.data() + begin,
                        .area_m2 = cloud_.area_m2.data() + begin},
                       view, settings.defocus, settings.shading, splats_.splats.get() + begin,
                       splats_.tiles.get() + begin);
    });
    return renderPaper(splats_, lists_, view, settings, !cloud_.opacity.empty(), frame);
  }

 private:
  const SurfelCloud& cloud_;
  PaperSplats splats_;
  PaperTileLists lists_;
};

}  // namespace

MethodEntry paperMethod() {
  return {
      .info = {.name = "paper",
               .summary = "the published baseline: each splat blurred, an A-buffer of fragments",
               .source = "Krivanek, Zara and Bouatouch 2003",
               .family = MethodFamily::paper},
      .make = makeAs<PaperMethod>};
}

}  // namespace foci
