// Composites the Gaussians of a tile front to back, as one sub-aperture sees them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "render/gaussians/projected.h"
#include "render/splat/bin.h"

namespace foci {

/// Places of a tile's samples: rows of `rowOf` places, of which the first `samples` are used.
inline constexpr std::size_t kTilePlaces = std::size_t{kTile + 2 * kApron} * 48;
constexpr std::size_t rowOf(int samples) { return samples == kTile ? kTile : 48; }

/// A tile's share of the frame: sums over sub-apertures.
struct TileSums {
  alignas(64) float red[kTilePlaces], green[kTilePlaces], blue[kTilePlaces];  ///< linear light
  alignas(64) float coverage[kTilePlaces], distance_m[kTilePlaces];  ///< distance times coverage
};

/// A disc within the lens, in lens radii.
struct LensDisc {
  glm::vec2 centre{0.0f};
  float radius = 0.0f;
};

/// A tile's Gaussians, front to back, as far as any sub-aperture has needed them. In blocks of
/// kBlock entries: each of the numbers below is kBlock floats.
class TileGaussians {
 public:
  static constexpr std::size_t kBlock = 16;
  enum Number : std::size_t {
    x_px,
    y_px,
    vxx,
    vxy,
    vyy,
    sx,
    sy,
    e,
    off_D,
    opacity,
    cut,
    red,
    green,
    blue,
    distance_m,
    kNumbers
  };

  /// @param list  of the tile; both outlive the tile
  void begin(const ProjectedGaussian* gaussians, std::span<const std::uint32_t> list);
  std::size_t size() const { return list_.size(); }

  /// Fetches the entries up to `end`, which are at most all.
  void fetch(std::size_t end) {
    while (fetched_ < end) fetchBlock();
  }
  /// A number of the fetched entries from `at` on, within a block.
  const float* at(Number number, std::size_t at) const {
    return values_.data() + (at / kBlock * kNumbers + number) * kBlock + at % kBlock;
  }

 private:
  void fetchBlock();

  const ProjectedGaussian* gaussians_ = nullptr;
  std::span<const std::uint32_t> list_;
  std::vector<float> values_;
  std::size_t fetched_ = 0;  // a multiple of kBlock
};

struct CompositeJob {
  TileGaussians* gaussians = nullptr;
  const Defocus* defocus = nullptr;
  glm::vec2 first_px{0.0f};  ///< the first sample
  float step_px = 1.0f;      ///< from sample to sample
  int samples = kTile;       ///< along a side: kTile, or with the apron
  LensDisc lens;
  glm::vec3 background{0.0f};  ///< display values
  bool depth = false;
};

/// Composites in display values, as scenes are trained, and adds the result to the sums in linear
/// light. Display values are clamped to 0 and 1 first.
/// @return the number of samples inside of the Gaussians' footprints
std::size_t compositeTile(const CompositeJob& job, TileSums& sums);

}  // namespace foci
