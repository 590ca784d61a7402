// Which splats touch which tile, front to back.
#pragma once

#include <algorithm>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <span>
#include <vector>

#include "render/splat/splat.h"

namespace foci {

/// A square of the image and how densely it is sampled: kTile samples along a side, `step_px`
/// apart, and where they are more than a pixel apart an apron of kApron more on each side, to
/// interpolate from.
struct Tile {
  int x_px = 0, y_px = 0;  ///< its corner
  int step_px = 1;         ///< a power of two, at most kMostStep_px
  float blur_px = 0.0f;    ///< the largest radius of blur in it
};

inline constexpr int kApron = 2;

/// Lists of splat indices by tile, each in order of `near_m` (ties and distances equal to about one
/// part in 10^5: in order of surfel). The order does not depend on the number of threads.
class TileLists {
 public:
  /// @param coarse  where nothing is sharper than a standard deviation of n pixels, samples are n
  ///                pixels apart
  void build(const SplatChunks& chunks, const glm::ivec2& size_px, bool coarse = false);

  const std::vector<Tile>& tiles() const { return tiles_; }
  std::span<const std::uint32_t> splats(std::size_t tile) const {
    return {entries_.data() + begin_[tile], entries_.data() + begin_[tile + 1]};
  }

 private:
  void sortByDistance(const SplatChunks& chunks);
  void chooseTiles(const SplatChunks& chunks, bool coarse);

  struct Sharpness {
    float sigma_px = std::numeric_limits<float>::infinity();  // the least
    float blur_px = 0.0f;                                     // the most
    void add(const Sharpness& other) {
      sigma_px = std::min(sigma_px, other.sigma_px);
      blur_px = std::max(blur_px, other.blur_px);
    }
  };
  std::vector<Sharpness> sharpnessOfCells(const SplatChunks& chunks) const;
  template <typename ForEachTile>
  void fill(const ForEachTile& forEachTile);

  glm::ivec2 size_px_{0}, cells_{0};  // a cell is a tile's square at a step of one pixel
  std::vector<Tile> tiles_;
  std::vector<std::uint32_t> tile_of_cell_;
  bool any_coarse_ = false;
  std::vector<std::uint64_t> sorted_, scratch_;  // key << 32 | splat
  std::vector<std::size_t> begin_;
  std::vector<std::size_t> cursor_;
  std::vector<std::uint32_t> entries_;
};

}  // namespace foci
