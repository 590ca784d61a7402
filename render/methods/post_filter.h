// The base of the post-filters: a finished pinhole image whose pixels become circles of confusion.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <vector>

#include "render/image/frame.h"
#include "render/optics/defocus.h"

namespace foci {

/// Vergence at each pixel of an image with depth, 1 / distance; 0 where the pixel is empty.
///
/// The post-filters of the literature read a depth buffer, which holds one surface at each pixel.
/// Our renderer's outlines are soft: their distance is a mean of both sides, where there is no
/// surface. This function sharpens them. Where the distances around a pixel differ by more than a
/// pixel of blur, the pixel takes the nearest or the farthest of these distances. It takes the one
/// that is closer to its own distance, which belongs to the surface that covers more of the pixel.
std::vector<float> vergences_D(const Frame& image, const Defocus& defocus);

/// Index of the pixel that replaces pixel `i`, which may lie outside [0, n): beyond its borders an
/// image continues as its own mirror image.
int mirrored(int i, int n);

/// Post-filters render no larger radius of the circle of confusion. Chosen by hand: it bounds their
/// time and their borders.
inline constexpr float kMaxRadius_px = 256.0f;

/// Radius of the circle of confusion along x and y, at most `kMaxRadius_px`, finite for every lens.
/// Post-filters have one radius at each pixel: an astigmatic lens counts as the round lens of the
/// same blur strength (`roundDefocus_D`).
inline glm::vec2 cappedRadius_px(const Defocus& defocus, float point_D) {
  const glm::vec2 finite = glm::min(defocus.radius_px_per_D, glm::vec2(1e6f));
  return glm::min(finite * std::abs(roundDefocus_D(defocus, point_D)), glm::vec2(kMaxRadius_px));
}

/// An image as a set of discs: each pixel spreads its light evenly over its circle of confusion.
///
/// A disc of radius C around a pixel centre gives the pixel at distance d the weight
///   max(0, min(1, C + 1/2 - d)),
/// which is nearly the disc's area on that pixel. The weights are divided by their sum. The
/// variance along an axis is C^2/4 + 5/48. On the grid of pixels this holds within 1 % from C = 3
/// on, and within 15 % from C = 1 on. Up to C = 1/2 no light leaves the pixel.
class DiscImage {
 public:
  static constexpr int kTile_px = 32;

  /// @param rgba, point_D  colour and vergence by pixel, row-major, size_px.x * size_px.y of each
  void set(const glm::ivec2& size_px, const std::vector<glm::vec4>& rgba,
           const std::vector<float>& point_D, const Defocus& defocus);

  glm::ivec2 size_px() const { return size_px_; }
  glm::ivec2 tiles() const { return (size_px_ + kTile_px - 1) / kTile_px; }
  int tileCount() const { return tiles().x * tiles().y; }
  /// Column and row of a tile.
  glm::ivec2 tileAt(int tile) const { return {tile % tiles().x, tile / tiles().x}; }

  /// Radius along x and y of a disc of that defocus, pixels.
  glm::vec2 radius_px(float defocus_D) const { return radius_px_per_D_ * std::abs(defocus_D); }
  /// Defocus at a pixel of the image, or up to `border_px` outside. Positive nearer than the focus.
  float defocus_D(int x, int y) const { return defocus_D_[indexOf(x, y)]; }
  const glm::vec4& rgba(int x, int y) const { return rgba_[indexOf(x, y)]; }
  /// Width of the mirrored border: no disc of the image reaches farther.
  int border_px() const { return border_px_; }
  /// The sum of a disc's weights before the division.
  float weightSum(float defocus_D) const;

  /// Sums the light that falls on the pixels of one tile, into `out`, which has the image's size.
  /// The order of the sum is always the same.
  void spreadOnto(int tile, std::vector<glm::vec4>& out) const;

  /// Calls visit(x, y, row, first, last, weights) for every disc and every row of the tile that the
  /// disc touches. The disc is that of the pixel (x, y). It touches the pixels [first, last] of the
  /// row, and weights[i - first] is the weight of pixel i.
  template <typename Visit>
  void forEachDiscOn(int tile, const Visit& visit) const;

 private:
  std::size_t indexOf(int x, int y) const {
    return static_cast<std::size_t>(y + border_px_) * stride_ + (x + border_px_);
  }

  glm::ivec2 size_px_{0};
  glm::vec2 radius_px_per_D_{0.0f};
  int border_px_ = 0;           // a multiple of the tile
  glm::ivec2 border_tiles_{0};  // tiles with the border
  std::size_t stride_ = 0;
  std::vector<glm::vec4> rgba_;
  std::vector<float> defocus_D_;
  std::vector<float> tile_max_D_;  // the largest defocus in each tile, with the border
  std::vector<float> sums_;        // of weights by radius
  glm::vec2 sums_for_{-1.0f};      // radius_px_per_D of `sums_`
};

template <typename Visit>
void DiscImage::forEachDiscOn(int tile, const Visit& visit) const {
  const glm::ivec2 at = tileAt(tile);
  const glm::ivec2 begin = at * kTile_px, end = glm::min(begin + kTile_px, size_px_);
  const int ring = border_px_ / kTile_px;
  float weights[kTile_px];

  for (int ty = at.y - ring; ty <= at.y + ring; ++ty) {
    for (int tx = at.x - ring; tx <= at.x + ring; ++tx) {
      // Skip the tile if none of its discs can reach this one.
      const float max_D = tile_max_D_[(ty + ring) * border_tiles_.x + tx + ring];
      const glm::vec2 reach_px = radius_px(max_D) + 0.5f;
      const glm::ivec2 from = glm::ivec2(tx, ty) * kTile_px, to = from + kTile_px;
      const glm::ivec2 gap_px = glm::max(from - (end - 1), begin - (to - 1));
      if (static_cast<float>(gap_px.x) >= reach_px.x) continue;
      if (static_cast<float>(gap_px.y) >= reach_px.y) continue;

      for (int y = from.y; y < to.y; ++y) {
        for (int x = from.x; x < to.x; ++x) {
          const float defocus = defocus_D(x, y);
          const glm::vec2 outer_px = radius_px(defocus) + 0.5f;
          const int rows = static_cast<int>(outer_px.y);
          const int top = std::max(begin.y, y - rows), bottom = std::min(end.y - 1, y + rows);
          if (top > bottom) continue;
          const float slope = std::min(outer_px.x, outer_px.y);
          const float scale = 1.0f / weightSum(defocus);
          const glm::vec2 inverse = 1.0f / outer_px;
          for (int row = top; row <= bottom; ++row) {
            const float ny = static_cast<float>(row - y) * inverse.y, ny2 = ny * ny;
            const int half = static_cast<int>(outer_px.x * std::sqrt(std::max(0.0f, 1.0f - ny2)));
            const int first = std::max(begin.x, x - half), last = std::min(end.x - 1, x + half);
            if (first > last) continue;
            for (int i = 0; i <= last - first; ++i) {
              const float nx = static_cast<float>(first + i - x) * inverse.x;
              const float inside = (1.0f - std::sqrt(nx * nx + ny2)) * slope;
              weights[i] = scale * std::clamp(inside, 0.0f, 1.0f);
            }
            visit(x, y, row, first, last, weights);
          }
        }
      }
    }
  }
}

}  // namespace foci
