// Composites the Gaussians of a tile front to back, as one sub-aperture sees them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "render/gaussians/projected.h"
#include "render/splat/bin.h"

namespace foci {

/// Places of a tile's samples: rows of `rowOf` places, of which the first `samples` are used.
inline constexpr std::size_t kTilePlaces = std::size_t{kTile + 2 * kApron} * 48;
constexpr std::size_t rowOf(int samples) { return samples == kTile ? kTile : 48; }

/// A tile's share of the frame: sums over sub-apertures, weighted.
struct TileSums {
  alignas(64) float red[kTilePlaces], green[kTilePlaces], blue[kTilePlaces];  ///< linear light
  alignas(64) float coverage[kTilePlaces], distance_m[kTilePlaces];  ///< distance times coverage
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
  glm::vec2 first_px{0.0f};  ///< the first sample
  float step_px = 1.0f;      ///< from sample to sample
  int samples = kTile;       ///< along a side: kTile, or with the apron
  LensDisc lens;
  glm::vec3 background{0.0f};  ///< display values
  bool depth = false;
  float weight = 1.0f;  ///< of this sub-aperture
};

/// Composites in display values, as scenes are trained, and adds the result to the sums in linear
/// light. Display values are clamped to 0 and 1 first.
/// @return the number of samples inside of the Gaussians' footprints
std::size_t compositeTile(const CompositeJob& job, TileSums& sums);

}  // namespace foci
