// Two and a half dimensions: the scene is sorted into layers by depth. Each layer is rendered
// without blur, blurred uniformly, and composited over the layers behind it (Scofield, 2 1/2-D
// Depth-of-Field Simulation for Computer Animation, Graphics Gems III, 1992). So surfaces behind a
// blurred one are present and show through. Scofield's layers are groups of objects. A scan has
// only surfels, so here a layer is one of N equal steps of vergence around the focus. Known
// failure: blur grows in steps, because it is the same everywhere in a layer. A surface that
// crosses several layers comes apart at their borders.
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "render/methods/method.h"
#include "render/methods/post_filter.h"
#include "render/methods/view_splats.h"

namespace foci {
namespace {

/// The thinnest layer: half a pixel of blur, below which steps are not visible, and 1e-4 D, which
/// bounds the number of layers of an extreme lens. Both chosen by hand.
constexpr float kMinStep_px = 0.5f;
constexpr float kMinStep_D = 1e-4f;

float vergence_D(const Splat& splat) { return 2.0f / (splat.near_m + splat.far_m); }

class LayeredMethod final : public Method {
 public:
  LayeredMethod(const SurfelCloud& cloud, int layers)
      : cloud_(cloud), camera_(cloud), layers_(layers) {}

  RenderStats renderFrame(const View& view, const RenderSettings& settings, Frame& frame) override {
    RenderStats stats;
    if (settings.depth) {
      stats = camera_.render(view, settings, frame);
    } else {
      frame.depth_m.clear();
    }
    const std::size_t pixels = static_cast<std::size_t>(view.size_px.x) * view.size_px.y;
    frame.size_px = view.size_px;
    frame.rgba.assign(pixels, glm::vec4(settings.lighting.background, 0.0f));

    scene_.project(cloud_, view, settings, {.aperture = 0.0f});
    stats.splats = scene_.count();
    float min_D = std::numeric_limits<float>::max(), max_D = 0.0f;
    scene_.forEach([&](const Splat& splat) {
      min_D = std::min(min_D, vergence_D(splat));
      max_D = std::max(max_D, vergence_D(splat));
    });
    const float focus_D = settings.defocus.focus_D;
    const float widest =
        std::max(settings.defocus.radius_px_per_D.x, settings.defocus.radius_px_per_D.y);
    const float step_D =
        std::max({(max_D - min_D) / static_cast<float>(layers_), kMinStep_px / widest, kMinStep_D});
    // Layer 0 is in focus and reaches half a step to both sides.
    const auto layerOf = [&](const Splat& splat) {
      const float steps = (vergence_D(splat) - focus_D) / step_D;
      return static_cast<int>(std::floor(std::clamp(steps, -1e4f, 1e4f) + 0.5f));
    };
    int farthest = std::numeric_limits<int>::max(), nearest = std::numeric_limits<int>::min();
    scene_.forEach([&](const Splat& splat) {
      farthest = std::min(farthest, layerOf(splat));
      nearest = std::max(nearest, layerOf(splat));
    });

    for (int number = farthest; number <= nearest; ++number) {  // of an empty scene: none
      layer_.select(scene_, [&](const Splat& splat) { return layerOf(splat) == number; });
      if (layer_.count() == 0) continue;
      stats.fragments += layer_.render(glm::vec3(0.0f), false, image_);
      if (number != 0 || isAstigmatic(settings.defocus)) blur(settings.defocus);
      for (std::size_t p = 0; p < pixels; ++p) {
        const glm::vec4& front = image_.rgba[p];
        frame.rgba[p] = front + (1.0f - front.a) * frame.rgba[p];
      }
    }
    return stats;
  }

 private:
  /// Blurs the image of the layer by the blur of its mean vergence.
  void blur(const Defocus& defocus) {
    double sum_D = 0.0;
    layer_.forEach([&](const Splat& splat) { sum_D += vergence_D(splat); });
    const auto mean_D = static_cast<float>(sum_D / static_cast<double>(layer_.count()));
    // Empty pixels have no light to spread: treat them as in focus.
    std::vector<float> point_D(image_.rgba.size());
    std::ranges::transform(image_.rgba, point_D.begin(), [&](const glm::vec4& pixel) {
      return pixel.a > 0.0f ? mean_D : defocus.focus_D;
    });
    discs_.set(image_.size_px, image_.rgba, point_D, defocus);
    parallelFor(static_cast<std::size_t>(discs_.tileCount()),
                [&](std::size_t tile) { discs_.spreadOnto(static_cast<int>(tile), image_.rgba); });
  }

  const SurfelCloud& cloud_;
  PinholeCamera camera_;
  int layers_;
  ViewSplats scene_, layer_;
  Frame image_;
  DiscImage discs_;
};

}  // namespace

MethodEntry layeredMethod() {
  return {.info = {.name = "layered",
                   .summary =
                       "N depth layers, each rendered, blurred and composited over those behind it",
                   .source = "Scofield 1992",
                   .family = MethodFamily::splatting,
                   .max_n = 256,
                   .default_n = 8,
                   .ellipses = false},
          .make = makeAs<LayeredMethod>};
}

}  // namespace foci
