// A surfel on the image as the paper's methods render it, a truncated Gaussian, and which splats
// touch which tile.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

namespace foci {

/// Cutoff c: a kernel ends at x' W^-1 x / 2 = c. The paper's value (section 6.3;
/// docs/formulas.md, section 5).
inline constexpr float kPaperCutoff = 2.5f;

/// A splat, one cache line. (dx, dy) is the offset of a pixel centre from the splat's centre, in
/// pixels. The weight of the pixel is height exp(t) where t > 0, with
///   t = c - (qa dx^2 + qb dx dy + qc dy^2).
/// Over all pixels the weights sum to the surfel's projected area in pixels.
struct alignas(64) PaperSplat {
  float x_px, y_px;
  float qa, qb, qc;
  float height;
  float red, green, blue;          ///< linear, times opacity
  float opacity;                   ///< 0 to 1
  float near_m, far_m;             ///< z-range of the blurred splat; far_m may be infinite
  float distance_m;                ///< of the centre, measured as `Defocus::along` says
  float extent_x_px, extent_y_px;  ///< half size of the footprint's bounding box
};
static_assert(sizeof(PaperSplat) == 64);

inline constexpr int kPaperTile_px = 32;

/// Range of the tiles that the footprint's bounding box touches, inclusive.
struct PaperSplatTiles {
  std::uint16_t x0, x1, y0, y1;
};

/// Splats of a frame in chunks, so that threads never share one. The memory between the chunks is
/// not initialised.
struct PaperSplats {
  struct Chunk {
    std::size_t begin;
    std::uint32_t count;
  };
  std::unique_ptr<PaperSplat[]> splats;
  std::unique_ptr<PaperSplatTiles[]> tiles;
  std::size_t capacity = 0;
  std::vector<Chunk> chunks;

  void reserve(std::size_t n) {
    if (capacity >= n) return;
    splats.reset();
    tiles.reset();
    splats = std::make_unique_for_overwrite<PaperSplat[]>(n);
    tiles = std::make_unique_for_overwrite<PaperSplatTiles[]>(n);
    capacity = n;
  }
  std::size_t total() const {
    std::size_t sum = 0;
    for (const Chunk& chunk : chunks) sum += chunk.count;
    return sum;
  }
};

/// Lists of splat indices by tile, each in the order of the chunks, at any number of threads. They
/// need no order of depth: an A-buffer takes its fragments in any order.
class PaperTileLists {
 public:
  void build(const PaperSplats& splats, const glm::ivec2& size_px);

  glm::ivec2 tiles() const { return tiles_; }
  std::span<const std::uint32_t> tile(std::size_t index) const {
    return {entries_.data() + begin_[index], entries_.data() + begin_[index + 1]};
  }

 private:
  glm::ivec2 tiles_{0};
  std::vector<std::size_t> begin_;
  std::vector<std::size_t> cursor_;
  std::vector<std::uint32_t> entries_;
};

}  // namespace foci
