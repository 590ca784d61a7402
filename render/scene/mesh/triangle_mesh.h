// The triangles of a mesh, with the colour and opacity of every place on them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <vector>

#include "render/scene/sampling/poisson_disk.h"
#include "render/scene/surfel_cloud.h"

namespace foci {

struct DecodedImage;

/// What a texture shows beyond its edges, for coordinates outside 0 to 1.
enum class TextureWrap : std::uint8_t { repeat, clamp, mirror };

/// A texture with its averaged levels (mipmaps).
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

/// What the alpha of the texture, of the mask and of the corners does. It is their product.
enum class AlphaUse : std::uint8_t {
  cut,    ///< less than `cutoff` is a hole, the rest has the material's opacity
  blend,  ///< multiplies the material's opacity
  none,
};

struct MeshMaterial {
  std::shared_ptr<const MeshTexture> texture = {};  ///< null: none
  std::shared_ptr<const MeshTexture> mask = {};     ///< its alpha, placed as `texture`; null: none
  glm::vec3 factor{1.0f};  ///< times the texture; the colour itself if there is no texture
  float opacity = 1.0f;
  AlphaUse alpha = AlphaUse::cut;
  float cutoff = 0.5f;                   ///< glTF's default alphaCutoff
  std::array<TextureWrap, 2> wrap = {};  ///< of `texture` and `mask` across u and v
  /// Whether colours of corners multiply this colour, as in glTF. Otherwise a texture replaces
  /// them, and they replace the colour of a material without one.
  bool tinted = false;
  bool unlit = false;   ///< its colour is light that it sends, and not to be shaded
  bool shaded = false;  ///< `colorAt` shades it where corners have no colour
};

/// Shading that shows the shape of surfaces whose colour does not. Chosen by eye.
inline constexpr double kPlainShading = 0.65;

/// The world frame is in metres, or in the units of the file where the reader says so.
struct TriangleMesh {
  std::vector<glm::vec3> corners_m;     ///< three a triangle, counter-clockwise from outside
  std::vector<glm::vec2> uv;            ///< one a corner
  std::vector<glm::vec3> color;         ///< one a corner, linear RGB; negative: none; empty: none
  std::vector<float> alpha = {};        ///< one a corner, 0 to 1; empty: 1
  std::vector<std::uint32_t> material;  ///< one a triangle
  /// One a triangle: number of the closed surface it belongs to, from 1; 0: none. Empty: unknown.
  std::vector<std::uint16_t> body = {};
  /// One a triangle: number of the connected surface it belongs to, from 0. Empty: unknown.
  std::vector<std::uint32_t> surface = {};
  SceneObjects objects = {};            ///< by triangle
  std::vector<std::string> remarks;     ///< see `PointCloud`
  std::vector<MeshMaterial> materials;  ///< a triangle may name one beyond the end: the default

  std::size_t size() const { return corners_m.size() / 3; }
};

/// Keeps the values whose mark is set; a mark is for `each` values. An empty vector stays empty.
template <typename T>
void keepMarked(std::vector<T>& values, const std::vector<std::uint8_t>& marks,
                std::size_t each = 1) {
  if (values.empty()) return;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (marks[i / each] != 0) values[kept++] = values[i];
  }
  values.resize(kept);
}

/// Whether `a` comes first by x, then y, then z.
bool precedes(const glm::vec3& a, const glm::vec3& b);

/// Drops triangles without an area, which would count for the bounds, and those that have corners,
/// material and winding of an earlier one, whose area would count as surface.
/// @return the number of the latter
std::size_t dropUseless(TriangleMesh& mesh);

struct MeshColor {
  glm::vec3 color;  ///< linear RGB
  float opacity;    ///< 0 to 1; 0 in a hole
};

/// The linear colour comes from the first of these that the triangle has: the texture (times the
/// material's factor in glTF), the vertices, the material. Light is added to shaded materials only:
///
///   L = 1 - s (1 - n l) / 2, with s = kPlainShading and l at an angle to all axes
///
/// @param footprint_m  side of the square over which the texture is averaged
MeshColor colorAt(const TriangleMesh& mesh, const MeshPoint& point, float footprint_m);

}  // namespace foci
