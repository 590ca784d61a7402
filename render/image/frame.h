// A rendered frame in linear light, and linear filters of images.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <vector>

namespace foci {

class GpuImage;

/// Row-major, top row first. `rgba` holds linear RGB, composited over the background, and the
/// coverage, 0 to 1.
struct Frame {
  glm::ivec2 size_px{0, 0};
  std::vector<glm::vec4> rgba;
  /// Distance of the visible surfaces, coverage-weighted; 0 where there is none. Empty unless asked
  /// for.
  std::vector<float> depth_m;
  /// The pixels are on the GPU, and those above have no meaning. Null except where a function says
  /// that it leaves pixels there (render/gl/image.h).
  std::shared_ptr<GpuImage> gpu = nullptr;

  /// @param depth  whether the frame has depth
  void resize(const glm::ivec2& to_px, bool depth = false) {
    const std::size_t pixels = static_cast<std::size_t>(to_px.x) * to_px.y;
    size_px = to_px;
    rgba.resize(pixels);
    depth_m.resize(depth ? pixels : 0);
  }

  const glm::vec4& at(int x, int y) const {
    return rgba[static_cast<std::size_t>(y) * size_px.x + x];
  }
};

/// What stands for a pixel beyond the edge: the edge's own, or the one as far inside.
enum class ImageBorder : std::uint8_t { replicate, reflect };

/// Convolves rows, then columns, with a symmetric kernel, in place.
/// @param kernel  from its centre outwards; not empty
void filterSeparably(std::vector<glm::vec4>& pixels, const glm::ivec2& size_px,
                     const std::vector<float>& kernel, ImageBorder border);

}  // namespace foci
