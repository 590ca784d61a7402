// A texture with its averaged levels (mipmaps). Private to the triangle mesh.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace foci {

struct DecodedImage;

/// What a texture shows beyond its edges, for coordinates outside 0 to 1.
enum class TextureWrap : std::uint8_t { repeat, clamp, mirror };

class MeshTexture {
 public:
  /// @param image  sRGB; not empty
  explicit MeshTexture(const DecodedImage& image);

  glm::vec2 size_px() const;

  /// Linear RGBA, row by row.
  const std::vector<std::array<std::uint16_t, 4>>& pixels() const { return levels_[0].pixels; }

  /// Linear RGB and alpha at `uv`; the origin is the lower left.
  /// @param footprint_px  side of the square to average over, in pixels of the image
  /// @param wrap          across u and v
  glm::vec4 at(const glm::vec2& uv, float footprint_px,
               const std::array<TextureWrap, 2>& wrap = {}) const;

 private:
  struct Level {
    int columns, rows;
    std::vector<std::array<std::uint16_t, 4>> pixels;  // linear RGBA, row by row
  };
  static Level halved(const Level& level);

  std::vector<Level> levels_;  // each half as large as the one before
};

}  // namespace foci
