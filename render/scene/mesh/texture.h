// A texture with its averaged levels (mipmaps). Private to the triangle mesh.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace cv {
class Mat;
}

namespace foci {

class MeshTexture {
 public:
  /// @param image  8 or 16 bits, 1, 3 or 4 channels in OpenCV's order (BGRA), sRGB; not empty
  explicit MeshTexture(const cv::Mat& image);

  glm::vec2 size_px() const;

  /// Linear RGB and alpha at `uv`. The texture repeats outside 0 to 1; the origin is its lower
  /// left.
  /// @param footprint_px  side of the square to average over, in pixels of the image
  glm::vec4 at(const glm::vec2& uv, float footprint_px) const;

 private:
  struct Level {
    int columns, rows;
    std::vector<std::array<std::uint16_t, 4>> pixels;  // linear RGBA, row by row
  };
  std::vector<Level> levels_;  // each half as large as the one before
};

}  // namespace foci
