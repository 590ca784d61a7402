// Composites the Gaussians of a tile front to back, as one sub-aperture sees them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "render/gaussians/projected.h"
#include "render/splat/splat.h"

namespace foci {

/// Pixels of a tile, row by row.
inline constexpr std::size_t kTilePixels = std::size_t{kTile} * kTile;

/// A tile's share of the frame: sums over sub-apertures, weighted.
struct TileSums {
  alignas(64) float red[kTilePixels], green[kTilePixels], blue[kTilePixels];  ///< linear light
  alignas(64) float coverage[kTilePixels], distance_m[kTilePixels];  ///< distance times coverage
};

/// A disc within the lens, in lens radii.
struct LensDisc {
  glm::vec2 centre{0.0f};
  float radius = 0.0f;
};

struct CompositeJob {
  const ProjectedGaussian* gaussians = nullptr;
  std::span<const std::uint32_t> list;  ///< of the tile, front to back
  const Defocus* defocus = nullptr;
  glm::vec2 corner_px{0.0f};
  LensDisc lens;
  glm::vec3 background{0.0f};  ///< display values
  bool depth = false;
  float weight = 1.0f;  ///< of this sub-aperture
};

/// Composites in display values, as scenes are trained, and adds the result to the sums in linear
/// light. Display values are clamped to 0 and 1 first.
/// @return the number of pixels inside of the Gaussians' footprints
std::size_t compositeTile(const CompositeJob& job, TileSums& sums);

}  // namespace foci
