// Coherence from frame to frame (Fearing, Importance Ordering for Real-Time Depth of Field, ICSC
// 1995; Technical Report TR-96-06, University of British Columbia, 1996). Unchanged parts of the
// frame are reused. Changed parts are computed in the order of their importance: the change of
// colour and blur since the part was last computed. Each part is computed as in `potmesil`.
// Fearing's parts are pixels, and a time limit ends the frame. Here the parts are tiles, and at
// most N per cent of them are computed in a frame, so that the same input gives the same image.
// Known failure: the failures of `potmesil`. With N below 100, some tiles show an earlier focus.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "render/literature/filter_method.h"

namespace foci {
namespace {

class FearingMethod final : public FilterMethod {
 public:
  FearingMethod(const SurfelCloud& cloud, int percent) : FilterMethod(cloud), percent_(percent) {}

 private:
  void filter(const View&, const Defocus& defocus, Frame& frame) override {
    discs_.set(frame.size_px, frame.rgba, vergences_D(frame, defocus), defocus);
    if (shown_.size_px != frame.size_px) {
      // Before the first frame, the sharp image counts as shown.
      shown_.size_px = frame.size_px;
      shown_.rgba = seen_rgba_ = frame.rgba;
      seen_radius_px_.assign(frame.rgba.size(), 0.0f);
      importance_.assign(static_cast<std::size_t>(discs_.tileCount()), 0.0);
    }
    addImportance(frame);

    std::vector<int> order(importance_.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, [&](int a, int b) { return importance_[a] > importance_[b]; });
    order.resize((order.size() * percent_ + 99) / 100);
    while (!order.empty() && importance_[order.back()] == 0.0) order.pop_back();
    parallelFor(order.size(), [&](std::size_t i) {
      discs_.spreadOnto(order[i], shown_.rgba);
      importance_[order[i]] = 0.0;
    });

    frame.rgba = shown_.rgba;
  }

  /// Adds the change since the last frame to the importance of each tile that its light reaches.
  void addImportance(const Frame& frame) {
    struct Change {
      double sum = 0.0;
      float reach_px = 0.0f;  // of the changed light, before or now
    };
    const glm::ivec2 tiles = discs_.tiles();
    std::vector<Change> changes(importance_.size());
    forEachTile([&](int t, const glm::ivec2& begin, const glm::ivec2& end) {
      for (int y = begin.y; y < end.y; ++y) {
        for (int x = begin.x; x < end.x; ++x) {
          const std::size_t p = static_cast<std::size_t>(y) * frame.size_px.x + x;
          const glm::vec2 radii_px = discs_.radius_px(discs_.defocus_D(x, y));
          const float radius_px = std::max(radii_px.x, radii_px.y);
          const glm::vec4 colour = glm::abs(frame.rgba[p] - seen_rgba_[p]);
          const float change =
              colour.r + colour.g + colour.b + colour.a + std::abs(radius_px - seen_radius_px_[p]);
          if (change > 0.0f) {
            changes[t].sum += change;
            changes[t].reach_px = std::max({changes[t].reach_px, radius_px, seen_radius_px_[p]});
          }
          seen_rgba_[p] = frame.rgba[p];
          seen_radius_px_[p] = radius_px;
        }
      }
    });
    for (int t = 0; t < static_cast<int>(changes.size()); ++t) {
      if (changes[t].sum == 0.0) continue;
      const int ring = static_cast<int>(
          std::ceil((changes[t].reach_px + 0.5f) / static_cast<float>(DiscImage::kTile_px)));
      const glm::ivec2 first = glm::max(discs_.tileAt(t) - ring, glm::ivec2(0));
      const glm::ivec2 last = glm::min(discs_.tileAt(t) + ring, tiles - 1);
      for (int y = first.y; y <= last.y; ++y) {
        for (int x = first.x; x <= last.x; ++x) importance_[y * tiles.x + x] += changes[t].sum;
      }
    }
  }

  std::size_t percent_;
  Frame shown_;                       // the previous frame
  std::vector<double> importance_;    // by tile, since the tile was last computed
  std::vector<glm::vec4> seen_rgba_;  // of the last pinhole image
  std::vector<float> seen_radius_px_;
};

}  // namespace

MethodEntry fearingMethod() {
  return filterEntry<FearingMethod>(
      {.name = "fearing",
       .summary = "potmesil where the image changed, at most N per cent of the frame",
       .source = "Fearing 1995",
       .family = MethodFamily::post_filter,
       .max_n = 100,
       .default_n = 100,
       .incremental = true});
}

}  // namespace foci
