// Accurate at the gaze, cheap elsewhere (Mulder and van Liere, Fast Perception-Based Depth of Field
// Rendering, VRST 2000; their version uses graphics hardware). Within 5 degrees of the gaze, each
// pixel is spread over its circle of confusion, as in `potmesil`. Outside, a pixel is looked up in
// a pyramid of low-passed images, at the level of its blur. The gaze is assumed to rest on the
// image's principal point. Known failure: inside, the failures of `potmesil`. Outside, a blurred
// surface keeps a sharp outline, a sharp surface leaks into the blur around it, and the squares of
// the pyramid are visible. A seam separates the two parts.
#include <cmath>

#include "render/literature/filter_method.h"

namespace foci {
namespace {

/// Half-angle of the accurate part: about the parafovea. Our choice.
const float kAccurate_tangent = std::tan(glm::radians(5.0f));

struct Level {
  glm::ivec2 size_px;
  std::vector<glm::vec4> rgba;
};

/// Halves the size: means of 2 x 2 pixels. At an odd end the last pixel counts twice.
Level halved(const Level& level) {
  Level half{.size_px = (level.size_px + 1) / 2, .rgba = {}};
  half.rgba.resize(static_cast<std::size_t>(half.size_px.x) * half.size_px.y);
  parallelFor(static_cast<std::size_t>(half.size_px.y), [&](std::size_t row) {
    const int y = static_cast<int>(row), width = level.size_px.x;
    const glm::vec4* upper = level.rgba.data() + static_cast<std::size_t>(2 * y) * width;
    const glm::vec4* lower =
        level.rgba.data() +
        static_cast<std::size_t>(std::min(2 * y + 1, level.size_px.y - 1)) * width;
    for (int x = 0; x < half.size_px.x; ++x) {
      const int left = 2 * x, right = std::min(2 * x + 1, width - 1);
      half.rgba[row * half.size_px.x + x] =
          0.25f * (upper[left] + upper[right] + lower[left] + lower[right]);
    }
  });
  return half;
}

/// Bilinear interpolation at a place in pixels of the level. Beyond the outer pixel centres the
/// result is that of the nearest pixel.
glm::vec4 sampleAt(const Level& level, const glm::vec2& place_px) {
  const glm::vec2 last(level.size_px - 1);
  const glm::vec2 p = glm::clamp(place_px - 0.5f, glm::vec2(0.0f), last);
  const glm::ivec2 at(p), next = glm::min(at + 1, level.size_px - 1);
  const glm::vec2 t = p - glm::vec2(at);
  const auto pixel = [&](int x, int y) {
    return level.rgba[static_cast<std::size_t>(y) * level.size_px.x + x];
  };
  return glm::mix(glm::mix(pixel(at.x, at.y), pixel(next.x, at.y), t.x),
                  glm::mix(pixel(at.x, next.y), pixel(next.x, next.y), t.x), t.y);
}

class MulderMethod final : public FilterMethod {
  using FilterMethod::FilterMethod;

  void filter(const View& view, const Defocus& defocus, Frame& frame) override {
    const std::vector<float> point_D = vergences_D(frame, defocus);
    discs_.set(frame.size_px, frame.rgba, point_D, defocus);
    buildPyramid(frame, point_D, defocus);
    forEachTile([&](int tile, const glm::ivec2& begin, const glm::ivec2& end) {
      const glm::vec2 nearest = glm::clamp(view.principal_px, glm::vec2(begin), glm::vec2(end));
      if (accurateAt(view, nearest)) discs_.spreadOnto(tile, frame.rgba);
      for (int y = begin.y; y < end.y; ++y) {
        for (int x = begin.x; x < end.x; ++x) {
          const glm::vec2 place(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
          if (accurateAt(view, place)) continue;
          const std::size_t p = static_cast<std::size_t>(y) * frame.size_px.x + x;
          const glm::vec2 radius_px = cappedRadius_px(defocus, point_D[p]);
          frame.rgba[p] = lookUp(place, std::sqrt(radius_px.x * radius_px.y));
        }
      }
    });
  }

  static bool accurateAt(const View& view, const glm::vec2& place_px) {
    const glm::vec2 tangent = (place_px - view.principal_px) / view.focal_px;
    return glm::length(tangent) < kAccurate_tangent;
  }

  /// Builds levels up to the level of the widest blur.
  void buildPyramid(const Frame& frame, const std::vector<float>& point_D, const Defocus& defocus) {
    float widest_px = 0.0f;
    for (float point : point_D) {
      const glm::vec2 radius_px = cappedRadius_px(defocus, point);
      widest_px = std::max({widest_px, radius_px.x, radius_px.y});
    }
    levels_.resize(1);
    levels_[0] = {frame.size_px, frame.rgba};
    for (float blur_px = 0.0f; blur_px < widest_px; blur_px = std::max(2.0f, 2.0f * blur_px)) {
      levels_.push_back(halved(levels_.back()));
    }
  }

  /// The pyramid's image with the variance of a disc of radius C, which is C^2/4 along an axis. The
  /// interpolated level l has the variance 4^l/4 from l = 1 on, and level 0 has none. A mixture of
  /// two levels has the same mixture of their variances.
  glm::vec4 lookUp(const glm::vec2& place_px, float radius_px) const {
    const float variance_px2 = 0.25f * radius_px * radius_px;
    std::size_t level = 0;
    float below_px2 = 0.0f, above_px2 = 1.0f;
    while (variance_px2 > above_px2 && level + 2 < levels_.size()) {
      ++level;
      below_px2 = above_px2;
      above_px2 *= 4.0f;
    }
    const float scale = std::ldexp(1.0f, -static_cast<int>(level));
    const glm::vec4 finer = sampleAt(levels_[level], place_px * scale);
    if (level + 1 >= levels_.size()) return finer;
    const float t = std::min(1.0f, (variance_px2 - below_px2) / (above_px2 - below_px2));
    return glm::mix(finer, sampleAt(levels_[level + 1], place_px * (0.5f * scale)), t);
  }

  std::vector<Level> levels_;
};

}  // namespace

MethodEntry mulderMethod() {
  return filterEntry<MulderMethod>(
      {.name = "mulder",
       .summary = "potmesil around the image centre, a pyramid of blurred images elsewhere",
       .source = "Mulder and van Liere 2000",
       .family = MethodFamily::post_filter});
}

}  // namespace foci
