// A surfel as it falls on the image: what projection hands to the sweep.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace foci {

/// One cache line. With d the offset from the centre in pixels, q = qa dx^2 + qb dx dy + qc dy^2
/// and t = 1 - q, the weight at a pixel centre is k0 + k1 t + k2 t^2 for t > 0; over all pixels the
/// weights sum to the surfel's projected area in pixels.
struct alignas(64) Splat {
  float x_px, y_px;
  float qa, qb, qc;
  float k0, k1, k2;
  float red, green, blue;          ///< linear, times opacity
  float opacity;                   ///< negative: of an oriented surface that is seen from behind
  float near_m, far_m;             ///< distances that the unblurred splat spans
  float extent_x_px, extent_y_px;  ///< half size of the footprint's bounding box
};
static_assert(sizeof(Splat) == 64);

inline constexpr int kTile_px = 32;

/// What binning needs of a splat: the near end of its z-range and the tiles that its footprint's
/// box may reach, inclusive.
struct SplatKey {
  float near_m;
  std::uint16_t x0, x1, y0, y1;
};

/// Splats of a frame, in chunks of consecutive surfels so that threads never share one. Chunk c
/// holds `count[c]` splats from index c * chunk_size on; what lies behind them is unset.
struct SplatChunks {
  std::unique_ptr<Splat[]> splats;
  std::unique_ptr<SplatKey[]> keys;
  std::size_t capacity = 0;
  std::size_t chunk_size = 0;
  std::vector<std::uint32_t> count;

  std::size_t total() const {
    std::size_t sum = 0;
    for (std::uint32_t n : count) sum += n;
    return sum;
  }
};

}  // namespace foci
