// What the sweep of one tile reads and writes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>

#include "render/kernel/kernel.h"
#include "render/optics/lens_field.h"
#include "render/splat/splat.h"
#include "render/splat/sweep.h"

namespace foci {

/// Splats are prefetched from memory this many before their use. Chosen by hand; `BM_SweepPlane`
/// measures it.
inline constexpr std::size_t kAhead = 16;

/// A tile, and how it is rendered.
struct TileJob {
  const Splat* splats;
  const std::uint32_t* entries;  // indices of the tile's splats, front to back
  std::size_t count;
  const std::uint8_t* gap;  // by entry: before it is a gap in depth across the whole tile
  int samples;              // along a side, with the apron
  float x, y;               // of the first sample, pixels
  float lens_x, lens_y;     // lens radii along the image's axes over their mean, for oblong pixels
  glm::vec2 meridian;       // the nearest meridian of an astigmatic lens
  float per_step;           // 1 / the distance of samples, pixels
  float background[3];
  float coverage;                // times a layer's weight (`closingFactor`)
  CoverageRamp ramp;             // under the blur of the whole aperture
  const SplatLens* lens;         // null: nothing is blurred
  const SplatLens* lens_across;  // null: the lens is round
  glm::vec2 radius_px_per_D;
  const SubApertures* sub_apertures;  // null: the whole aperture only
  float sub_aperture_share;           // of the image, where sub-apertures render it
  std::optional<LocalLens> local;     // of the tile's middle, where directions have their own lens
  glm::vec4* rgba;                    // samples x samples, all 0
  float* depth_m;                     // samples x samples, all 0; null: not asked for
};

}  // namespace foci
