// A ray distribution buffer behind each pixel (Shinya, Post-filtering for Depth of Field Simulation
// with Ray Distribution Buffer, Graphics Interface 1994). Every pixel of the finished pinhole image
// sends its light along N rays through points of the lens. Each ray meets one pixel. A pixel has a
// cell for each point of the lens, and the cell keeps the nearest light. The pixel is the mean of
// its cells, so rays hide each other one by one. Known failure: surfaces that the pinhole does not
// see send no rays, and their cells stay empty. The pixel is then the mean of the other cells, and
// the inner half of a blurred outline stays opaque. Time and memory grow with N. If N is below the
// number of pixels in a circle of confusion, ghosts appear.
#include <array>
#include <cstdint>

#include "render/literature/filter_method.h"
#include "render/methods/lens_samples.h"

namespace foci {
namespace {

/// Rays are processed in this many groups. Fixed, so that no sum depends on the number of threads;
/// chosen by hand.
constexpr int kGroups = 8;

/// Rounds a bounded shift to full pixels; cheaper than std::lround.
glm::ivec2 nearestPixel(const glm::vec2& shift_px) {
  constexpr int kAbove = 2 * static_cast<int>(kMaxRadius_px);
  return glm::ivec2(shift_px + (static_cast<float>(kAbove) + 0.5f)) - kAbove;
}

class ShinyaMethod final : public FilterMethod {
 public:
  ShinyaMethod(const SurfelCloud& cloud, int rays) : FilterMethod(cloud), rays_(rays) {}

 private:
  void filter(const View&, const Defocus& defocus, Frame& frame) override {
    discs_.set(frame.size_px, frame.rgba, vergences_D(frame, defocus), defocus);
    parallelFor(kGroups, [&](std::size_t group) {
      groups_[group].sums.assign(frame.rgba.size(), glm::vec4(0.0f));
      groups_[group].filled.assign(frame.rgba.size(), 0);
      for (int ray = static_cast<int>(group); ray < rays_; ray += kGroups) {
        sendThrough(lensSample(ray, rays_), groups_[group]);
      }
    });
    const auto width = static_cast<std::size_t>(frame.size_px.x);
    parallelFor(static_cast<std::size_t>(frame.size_px.y), [&](std::size_t y) {
      for (std::size_t p = y * width; p < (y + 1) * width; ++p) {
        glm::vec4 sum(0.0f);
        std::uint32_t filled = 0;
        for (const Group& group : groups_) {
          sum += group.sums[p];
          filled += group.filled[p];
        }
        if (filled > 0) frame.rgba[p] = sum / static_cast<float>(filled);
      }
    });
  }

  struct Group {
    std::vector<glm::vec4> sums;
    std::vector<std::uint32_t> filled;  // cells that received light
    // The cells of the current ray, by pixel: the nearest defocus so far, and its sender.
    std::vector<float> nearest_D;
    std::vector<glm::ivec2> sender;
  };

  /// Sends the light of every pixel along its ray through one point of the lens.
  void sendThrough(const glm::vec2& lens, Group& group) const {
    constexpr float kEmpty_D = -1e30f;
    const glm::ivec2 size = discs_.size_px();
    group.nearest_D.assign(group.sums.size(), kEmpty_D);
    group.sender.resize(group.sums.size());
    // Seen through the lens point l, a point moves on the image by -radius_px_per_D l (point -
    // focus).
    const glm::vec2 per_D = -lens * discs_.radius_px(1.0f);
    const int border = discs_.border_px();
    for (int y = -border; y < size.y + border; ++y) {
      for (int x = -border; x < size.x + border; ++x) {
        const float defocus_D = discs_.defocus_D(x, y);
        const glm::ivec2 at = glm::ivec2(x, y) + nearestPixel(per_D * defocus_D);
        if (at.x < 0 || at.y < 0 || at.x >= size.x || at.y >= size.y) continue;
        const std::size_t p = static_cast<std::size_t>(at.y) * size.x + at.x;
        if (defocus_D <= group.nearest_D[p]) continue;
        group.nearest_D[p] = defocus_D;
        group.sender[p] = {x, y};
      }
    }
    for (std::size_t p = 0; p < group.sums.size(); ++p) {
      if (group.nearest_D[p] == kEmpty_D) continue;
      group.sums[p] += discs_.rgba(group.sender[p].x, group.sender[p].y);
      ++group.filled[p];
    }
  }

  int rays_;
  std::array<Group, kGroups> groups_;
};

}  // namespace

MethodEntry shinyaMethod() {
  return filterEntry<ShinyaMethod>(
      {.name = "shinya",
       .summary = "N rays from each pixel of the pinhole image, hiding each other in ray buffers",
       .source = "Shinya 1994",
       .family = MethodFamily::post_filter,
       .max_n = 4096,
       .default_n = 64});
}

}  // namespace foci
