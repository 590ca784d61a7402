// A splat: the kernel that a surfel or a node of the level-of-detail tree leaves on the image.
// Projection writes splats, binning and the sweep read them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "base/large_array.h"

namespace foci {

/// One cache line. Let (dx, dy) be the offset from the centre in pixels,
///   q = qa dx^2 + qb dx dy + qc dy^2  and  t = 1 - q.
/// The weight at a pixel centre is min(k0, k1 t + k2 t^2) where t > 0, else 0 (kernel.h). Over all
/// pixels the weights sum to the surfel's projected area in pixels.
struct alignas(64) Splat {
  float x_px, y_px;
  float qa, qb, qc;
  float k0, k1, k2;
  float red, green, blue;          ///< linear, times opacity
  float opacity;                   ///< negative: back-facing, on an oriented surface
  float near_m, far_m;             ///< distances that the unblurred splat spans
  float extent_x_px, extent_y_px;  ///< half size of the footprint's bounding box
};
static_assert(sizeof(Splat) == 64);

/// Samples along a side of a tile.
inline constexpr int kTile = 32;

/// Largest distance of samples, pixels, in a tile whose splats are all blurred.
inline constexpr int kMaxStep_px = 8;

/// The data that binning needs of a splat.
struct SplatKey {
  float distance_m;  ///< of its centre
  /// Lower bound of the kernel's standard deviation; reduced for a highlight, so that binning
  /// chooses finer samples.
  float sigma_px;
  float blur_px;                 ///< blur radius
  std::uint16_t x0, x1, y0, y1;  ///< pixels that the footprint's box may reach, inclusive
};

/// The point of the lens that sees a splat at an offset d from its centre, pixels. The points have
/// the mean per_px d, in lens radii, and the standard deviation 1 / (sqrt(12) inv_width). For a
/// blur radius C and an unblurred variance s this is a linear regression:
///   per_px = C / (C^2 + 4 s), signed;  variance of the points = s / (C^2 + 4 s).
/// In focus, the whole lens sees every offset alike. An astigmatic lens has one SplatLens along its
/// nearest meridian (defocus.h) and another across it.
///
/// A slanted splat looks larger from one side of the lens. From the lens point l the factor is
/// 1 + tilt l, with
///
///   tilt = -R n / (n p).
///
/// n is the splat's normal, p its place from the centre of the lens, R the lens's radius, in
/// metres.
struct SplatLens {
  float per_px, inv_width;
  float tilt_x, tilt_y;  ///< 0 where the tilt is too small to matter
};

/// Number of surfels in a chunk, out of `n`: a multiple of any SIMD width, and few enough that
/// there are about as many chunks as the largest machine has threads. The size depends on `n` only,
/// so results do not depend on the number of threads.
inline constexpr std::size_t kMinChunk = 4096;
inline std::size_t chunkSize(std::size_t n) {
  constexpr std::size_t kMaxChunks = 64;
  return (n / kMaxChunks + kMinChunk) / kMinChunk * kMinChunk;
}

/// Splats of a frame, in chunks of consecutive surfels, so that threads never share a chunk. Chunk
/// c holds `count[c]` splats from index c * chunk_size on; elements after them are unset.
struct SplatChunks {
  LargeArray<Splat> splats;
  LargeArray<SplatKey> keys;
  LargeArray<SplatLens> lens;         ///< null: nothing is blurred
  LargeArray<SplatLens> lens_across;  ///< null: the lens is round
  /// The same splats, blurred by a sub-aperture; null: not asked for. The other two are their
  /// displacements (`SubApertures`).
  LargeArray<Splat> sub_aperture_splats;
  LargeArray<float> out_of_focus_D;
  LargeArray<float> out_across_D;  ///< null: the lens is round
  LargeArray<glm::mat2> lens_px;   ///< replaces both where directions have their own lens
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
