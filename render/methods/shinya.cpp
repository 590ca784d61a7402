// A buffer of rays behind each pixel: every pixel of the finished pinhole image sends its light
// along N rays through points of the lens; each ray meets one pixel of the image, where a depth
// buffer of its own, a cell for each point of the lens, keeps the nearest; a pixel is the mean of
// its cells (Shinya, Post-filtering for Depth of Field Simulation with Ray Distribution Buffer,
// Graphics Interface 1994). So rays hide each other one by one. Known failure: what the pinhole did
// not see cannot be sent, and its cells stay empty: a pixel takes the mean of the others, and the
// inner half of a blurred outline stays opaque. Time and memory grow with N, and with N below the
// pixels of a circle of confusion it shows as ghosts.
#include <array>
#include <cstdint>

#include "base/parallel.h"
#include "render/methods/lens_samples.h"
#include "render/methods/method.h"
#include "render/methods/post_filter.h"
#include "render/methods/view_splats.h"

namespace foci {
namespace {

/// Rays are worked on in this many groups; fixed, so that no sum hangs on the threads.
constexpr int kGroups = 8;

/// A shift rounded to whole pixels; cheaper than std::lround where shifts are bounded.
glm::ivec2 nearestPixel(const glm::vec2& shift_px) {
  constexpr int kAbove = 2 * static_cast<int>(kMaxRadius_px);
  return glm::ivec2(shift_px + (static_cast<float>(kAbove) + 0.5f)) - kAbove;
}

class ShinyaMethod final : public Method {
 public:
  ShinyaMethod(const SurfelCloud& cloud, int rays) : camera_(cloud), rays_(rays) {}

  RenderStats renderFrame(const View& view, const RenderSettings& settings, Frame& frame) override {
    RenderStats stats = camera_.render(view, settings, frame);
    discs_.set(frame.size_px, frame.rgba, vergences_D(frame, settings.defocus), settings.defocus);
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
    if (!settings.depth) frame.depth_m.clear();
    return stats;
  }

 private:
  struct Group {
    std::vector<glm::vec4> sums;
    std::vector<std::uint32_t> filled;  // cells that a ray met
    // The cell of the ray at work, by pixel: the nearest defocus so far and whose light it is.
    std::vector<float> nearest_D;
    std::vector<glm::ivec2> sender;
  };

  /// Sends every pixel along its ray through one point of the lens.
  void sendThrough(const glm::vec2& lens, Group& group) const {
    constexpr float kEmpty_D = -1e30f;
    const glm::ivec2 size = discs_.size_px();
    group.nearest_D.assign(group.sums.size(), kEmpty_D);
    group.sender.resize(group.sums.size());
    // A point moves on the image by C_per_D lens (focus - point).
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

  PinholeCamera camera_;
  int rays_;
  DiscImage discs_;
  std::array<Group, kGroups> groups_;
};

}  // namespace

MethodEntry shinyaMethod() {
  return {
      .info = {.name = "shinya",
               .summary = "N rays a pixel of the pinhole image, hiding each other in ray buffers",
               .source = "Shinya 1994",
               .most = 4096,
               .standard = 64,
               .ellipses = false},
      .make = makeAs<ShinyaMethod>};
}

}  // namespace foci
