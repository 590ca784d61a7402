// A post-filter without the two faults of `potmesil`, leakage and undervalued intensities, after
// Matthews (Analyzing and Improving Depth-of-Field Simulation in Digital Image Synthesis, Master's
// thesis, University of California, Santa Cruz, 1998). We know the thesis from the description by
// Krivanek, Zara and Bouatouch (2003), and the rules are our own:
//   1. Light from a farther surface reaches a pixel only from within the blur of the pixel's
//   surface.
//   2. The light that arrives is divided by the sum of its weights.
//   3. Light from a nearer surface covers the pixel by its own weights.
// Known failure: a finished image has one surface at each pixel. The surfaces behind a blurred one
// are missing, so the inner half of its blurred outline stays opaque.
#include "render/literature/filter_method.h"

namespace foci {
namespace {

class MatthewsMethod final : public FilterMethod {
  using FilterMethod::FilterMethod;

  void filter(const View&, const Defocus& defocus, Frame& frame) override {
    discs_.set(frame.size_px, frame.rgba, vergences_D(frame, defocus), defocus);
    forEachTile([&](int tile, const glm::ivec2& begin, const glm::ivec2& end) {
      filterTile(tile, begin, end, frame);
    });
  }

  /// Light that arrives at a pixel: from surfaces nearer than the pixel's own, and from the rest.
  struct Arrivals {
    glm::vec4 nearer{0.0f}, rest{0.0f};
    float nearer_weight = 0.0f, rest_weight = 0.0f;
  };

  void filterTile(int tile, const glm::ivec2& begin, const glm::ivec2& end, Frame& frame) const {
    constexpr int kTile_px = DiscImage::kTile_px;
    std::vector<Arrivals> arrivals(static_cast<std::size_t>(kTile_px) * kTile_px);

    discs_.forEachDiscOn(
        tile, [&](int x, int y, int row, int first, int last, const float* weights) {
          const float source_D = discs_.defocus_D(x, y);
          const float per_weight = 1.0f / discs_.weightSum(source_D);
          const glm::vec4& light = discs_.rgba(x, y);
          Arrivals* arrival = arrivals.data() + (row - begin.y) * kTile_px - begin.x;
          for (int i = first; i <= last; ++i) {
            const float target_D = discs_.defocus_D(i, row);
            float weight = weights[i - first];
            if (source_D > target_D) {
              arrival[i].nearer += weight * light;
              arrival[i].nearer_weight += weight;
              continue;
            }
            if (std::abs(target_D) < std::abs(source_D)) {
              // The density of light stays the same inside the circle of the nearer surface.
              const glm::vec2 outer_px = discs_.radius_px(target_D) + 0.5f;
              const float n = glm::length(glm::vec2(i - x, row - y) / outer_px);
              const float open = (1.0f - n) * std::min(outer_px.x, outer_px.y);
              if (open <= 0.0f) continue;
              weight = std::min(weight, open * per_weight);
            }
            arrival[i].rest += weight * light;
            arrival[i].rest_weight += weight;
          }
        });

    for (int y = begin.y; y < end.y; ++y) {
      for (int x = begin.x; x < end.x; ++x) {
        const Arrivals& a = arrivals[(y - begin.y) * kTile_px + (x - begin.x)];
        const float covered = std::min(1.0f, a.nearer_weight);
        const glm::vec4 front = a.nearer_weight > 1.0f ? a.nearer / a.nearer_weight : a.nearer;
        // a.rest_weight > 0: a pixel always reaches itself.
        frame.rgba[static_cast<std::size_t>(y) * frame.size_px.x + x] =
            front + (1.0f - covered) * (a.rest / a.rest_weight);
      }
    }
  }
};

}  // namespace

MethodEntry matthewsMethod() {
  return filterEntry<MatthewsMethod>(
      {.name = "matthews",
       .summary = "potmesil without leakage over sharper surfaces in front, normalised",
       .source = "after Matthews 1998",
       .family = MethodFamily::post_filter});
}

}  // namespace foci
