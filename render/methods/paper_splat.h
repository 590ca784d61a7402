// A surfel as the paper's methods render it: a true truncated Gaussian. Private to `paper` and
// `paper-lod`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace foci {

/// Cutoff c of the kernels, which end at x' W^-1 x / 2 = c (formulas.md, section 5).
inline constexpr float kPaperCutoff = 2.5f;

/// One cache line. With d the offset from the centre in pixels and t = c - (qa dx^2 + qb dx dy + qc
/// dy^2), the weight at a pixel centre is height exp(t) for t > 0; over all pixels the weights sum
/// to the surfel's projected area in pixels.
struct alignas(64) PaperSplat {
  float x_px, y_px;
  float qa, qb, qc;
  float height;
  float red, green, blue;          ///< linear, times opacity
  float opacity;                   ///< 0 to 1
  float near_m, far_m;             ///< z-range of the blurred splat; far_m may be infinite
  float distance_m;                ///< of the centre, as `Defocus::along` says
  float extent_x_px, extent_y_px;  ///< half size of the footprint's bounding box
};
static_assert(sizeof(PaperSplat) == 64);

inline constexpr int kPaperTile_px = 32;

/// Tiles that a footprint's box may reach, inclusive.
struct PaperSplatTiles {
  std::uint16_t x0, x1, y0, y1;
};

/// Splats of a frame in chunks, so that threads never share one. What lies between the chunks is
/// unset.
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

}  // namespace foci
