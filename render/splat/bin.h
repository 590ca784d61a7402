// Divides the image into tiles, lists the splats of each, front to back, and interpolates a tile's
// samples to the pixels of the frame.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "render/image/frame.h"
#include "render/splat/splat.h"

namespace foci {

/// Samples of an apron: cubic interpolation needs two beyond the tile's edge.
inline constexpr int kApron = 2;

/// Samples along a side of a tile with aprons.
inline constexpr int kMostSamples = kTile + 2 * kApron;

/// A square of the image and its samples: at most kTile along a side, `step_px` apart. Where
/// samples are more than a pixel apart, an apron of kApron samples on each side lets the tile
/// interpolate.
struct Tile {
  int x_px = 0, y_px = 0;  ///< top-left corner
  int side_px = kTile;
  int step_px = 1;       ///< a power of two, at most kMaxStep_px
  float blur_px = 0.0f;  ///< largest blur radius in the tile

  int apron() const { return step_px > 1 ? kApron : 0; }
  int samplesWithApron() const { return side_px / step_px + 2 * apron(); }
};

/// Largest distance of samples for kernels of at least this standard deviation: a power of two.
int stepFor(float sigma_px);

/// Splat indices of each tile, in order of distance. Distances that agree to about one part in 10^5
/// are equal, and their splats come in order of surfel. The order does not depend on the number of
/// threads.
class TileLists {
 public:
  /// @param coarse  whether tiles without detail finer than about n pixels have samples n pixels
  /// apart
  void build(const SplatChunks& chunks, const glm::ivec2& size_px, bool coarse = false);

  const std::vector<Tile>& tiles() const { return tiles_; }
  std::span<const std::uint32_t> splats(std::size_t tile) const {
    return {entries_.data() + begin_[tile], entries_.data() + begin_[tile + 1]};
  }

 private:
  void chooseTiles(const SplatChunks& chunks, bool coarse);

  struct Blur {
    int step_px = kMaxStep_px;  // largest distance of samples allowed
    float radius_px = 0.0f;     // largest
    void add(const Blur& other) {
      step_px = std::min(step_px, other.step_px);
      radius_px = std::max(radius_px, other.radius_px);
    }
  };
  std::uint32_t tileAt(int x, int y) const {
    return tile_of_cell_[static_cast<std::size_t>(y) * cells_.x + x];
  }
  int nearApron_px(int x, int y) const {
    return near_apron_px_[static_cast<std::size_t>(y) * cells_.x + x];
  }
  std::vector<Blur> blurOfCells(const SplatChunks& chunks) const;
  template <typename ForEachTile>
  void fill(const SplatChunks& chunks, const ForEachTile& forEachTile);

  /// The tiles that each splat of a chunk touches, in order: first their number, then their
  /// indices.
  class Touched {
   public:
    void clear() { size_ = 0; }
    /// Begins a splat that touches at most `max_tiles` tiles.
    void begin(std::size_t max_tiles) {
      if (data_.size() < size_ + 1 + max_tiles) data_.resize(2 * (size_ + 1 + max_tiles));
      first_ = size_ + 1;
      size_ = first_;
    }
    void add(std::uint32_t tile, bool counts) {
      data_[size_] = tile;
      size_ += counts;
    }
    void end() { data_[first_ - 1] = static_cast<std::uint32_t>(size_ - first_); }
    const std::uint32_t* data() const { return data_.data(); }

   private:
    std::vector<std::uint32_t> data_;
    std::size_t size_ = 0, first_ = 0;
  };

  glm::ivec2 size_px_{0}, cells_{0};  // a cell is the smallest tile
  std::vector<Tile> tiles_;
  std::vector<std::uint32_t> tile_of_cell_;
  std::vector<std::uint8_t> near_apron_px_;  // by cell: the largest of its tile and its neighbours'
  int max_apron_px_ = 0;                     // the largest of all
  std::vector<Touched> touched_;             // by chunk
  std::vector<std::uint64_t> pairs_;         // by tile, key << 32 | splat
  std::vector<std::size_t> begin_;
  std::vector<std::size_t> cursor_;
  std::vector<std::uint32_t> entries_;
};

/// Weights of four samples in a row, `t` of the way from the second to the third (Catmull and Rom
/// 1974).
inline std::array<float, 4> catmullRom(float t) {
  return {0.5f * t * (-1.0f + t * (2.0f - t)), 0.5f * (2.0f + t * t * (-5.0f + 3.0f * t)),
          0.5f * t * (1.0f + t * (4.0f - 3.0f * t)), 0.5f * t * t * (t - 1.0f)};
}

/// Writes the tile's pixels that lie on the frame. Samples one pixel apart are copied. Others are
/// interpolated by these cubics, which reproduce linear ramps.
/// @param rgba     rows of tile.samplesWithApron() samples
/// @param depth_m  depths times coverage, in the same layout; null: none
/// @param weight   over what the frame holds; 1: in its place
void interpolateTile(const Tile& tile, const glm::vec4* rgba, const float* depth_m, float weight,
                     Frame& frame);

}  // namespace foci
