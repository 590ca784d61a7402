// Which splats touch which tile, front to back.
#pragma once

#include <algorithm>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "render/splat/splat.h"

namespace foci {

inline constexpr int kApron = 2;

/// A square of the image and how densely it is sampled: at most kTile samples along a side,
/// `step_px` apart, and where they are more than a pixel apart an apron of kApron more on each
/// side, to interpolate from.
struct Tile {
  int x_px = 0, y_px = 0;  ///< its corner
  int side_px = kTile;
  int step_px = 1;       ///< a power of two, at most kMaxStep_px
  float blur_px = 0.0f;  ///< the largest radius of blur in it

  int apron() const { return step_px > 1 ? kApron : 0; }
  int samplesWithApron() const { return side_px / step_px + 2 * apron(); }
};

/// Lists of splat indices by tile, each in order of distance (ties and distances equal to about one
/// part in 10^5: in order of surfel). The order does not depend on the number of threads.
class TileLists {
 public:
  /// @param coarse  where nothing is sharper than about n pixels, samples are n pixels apart
  void build(const SplatChunks& chunks, const glm::ivec2& size_px, bool coarse = false);

  const std::vector<Tile>& tiles() const { return tiles_; }
  std::span<const std::uint32_t> splats(std::size_t tile) const {
    return {entries_.data() + begin_[tile], entries_.data() + begin_[tile + 1]};
  }

 private:
  void chooseTiles(const SplatChunks& chunks, bool coarse);

  struct Blur {
    int step_px = kMaxStep_px;  // as far apart may samples be
    float radius_px = 0.0f;     // the most
    void add(const Blur& other) {
      step_px = std::min(step_px, other.step_px);
      radius_px = std::max(radius_px, other.radius_px);
    }
  };
  bool isFine(int x, int y) const { return fine_[static_cast<std::size_t>(y) * cells_.x + x] != 0; }
  std::vector<Blur> blurOfCells(const SplatChunks& chunks) const;
  template <typename ForEachTile>
  void fill(const SplatChunks& chunks, const ForEachTile& forEachTile);

  /// Tiles that each splat of a chunk touches, in order: their number, then they.
  class Touched {
   public:
    void clear() { size_ = 0; }
    /// Room for a splat with as many tiles.
    void begin(std::size_t most) {
      if (data_.size() < size_ + 1 + most) data_.resize(2 * (size_ + 1 + most));
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

  glm::ivec2 size_px_{0}, cells_{0};  // a cell is the least tile
  std::vector<Tile> tiles_;
  std::vector<std::uint32_t> tile_of_cell_;
  std::vector<std::uint8_t> fine_;    // by cell: neither it nor a neighbour has coarser samples
  int max_apron_px_ = 0;              // of all tiles
  std::vector<Touched> touched_;      // by chunk
  std::vector<std::uint64_t> pairs_;  // by tile, key << 32 | splat
  std::vector<std::size_t> begin_;
  std::vector<std::size_t> cursor_;
  std::vector<std::uint32_t> entries_;
};

}  // namespace foci
