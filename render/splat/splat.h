// A surfel as it falls on the image: what projection hands to the sweep.
#pragma once

#include <algorithm>
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

/// Samples along a side of a tile.
inline constexpr int kTile = 32;

/// A tile whose splats are all blurred has its samples this far apart at most, pixels.
inline constexpr int kMaxStep_px = 8;

/// What binning needs of a splat: the distance of its centre, the pixels of the image that its
/// footprint's box may reach, inclusive, a lower bound of its kernel's standard deviation (of a
/// highlight less, which wants finer samples) and the radius of its blur.
struct SplatKey {
  float distance_m;
  float sigma_px, blur_px;
  std::uint16_t x0, x1, y0, y1;
};

/// Which part of the lens sees a splat at an offset d from its centre, pixels: on the mean the one
/// at per_px d lens radii, with a standard deviation of 1 / (sqrt(12) inv_width). With blur of
/// radius C and unblurred variance s these are a linear regression: C / (C^2 + 4 s), signed, and
/// s / (C^2 + 4 s); in focus the whole lens sees the same. An astigmatic lens has one of these
/// along its nearest meridian (defocus.h) and another across it.
///
/// A slanted splat is seen larger from one side of the lens: from the point l by 1 + tilt l,
///   tilt = -R n / (n p),
/// n its normal, p its place seen from the lens's centre and R the lens's radius, in metres.
struct SplatLens {
  float per_px, inv_width;
  float tilt_x, tilt_y;  ///< 0 where it is little
};

/// Surfels a chunk, of `n`: whole SIMD steps, and about as many chunks as the largest machine has
/// threads. Fixed, so that no result hangs on the threads.
inline constexpr std::size_t kMinChunk = 4096;
inline std::size_t chunkSize(std::size_t n) {
  constexpr std::size_t kMaxChunks = 64;
  return (n / kMaxChunks + kMinChunk) / kMinChunk * kMinChunk;
}

/// Splats of a frame, in chunks of consecutive surfels so that threads never share one. Chunk c
/// holds `count[c]` splats from index c * chunk_size on; what lies behind them is unset.
struct SplatChunks {
  std::unique_ptr<Splat[]> splats;
  std::unique_ptr<SplatKey[]> keys;
  std::unique_ptr<SplatLens[]> lens;         ///< null: nothing is blurred
  std::unique_ptr<SplatLens[]> lens_across;  ///< null: the lens is round
  std::unique_ptr<Splat[]>
      parts;  ///< the same splats blurred by a part of the lens, where asked for
  std::unique_ptr<float[]> out_of_focus_D;  ///< likewise: how parts see them move
  std::unique_ptr<float[]> out_across_D;    ///< likewise, of an astigmatic lens
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
