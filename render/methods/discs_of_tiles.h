// How many discs of the lens each tile of a frame is rendered through: as few as keep 95 % of the
// frame's pixels below the tolerance.
#pragma once

#include <array>
#include <cstddef>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "render/gaussians/tile_layers.h"
#include "render/gaussians/view_spread.h"

namespace foci {

/// The numbers of discs that a tile may be rendered through. More numbers would take less time, but
/// a tile changes where its number does.
inline constexpr std::array kDiscs{1, 3, 7, 19, 61, 127};

/// Renders in rounds: `choose` once, then render the tiles that `isNext`, and `refine`, until it
/// returns false.
class DiscsOfTiles {
 public:
  /// Gives a layer one disc where the blur is small, else three or more; one behind another layer
  /// seven or more: its views take little time, and lie far apart.
  /// @param merging  error of a tile's merged Gaussians, in just-noticeable differences
  void choose(std::span<const Tile> tiles, const glm::ivec2& size_px,
              std::span<const TileLayers> layers, std::span<const float> merging, float tolerance);

  bool isNext(std::size_t tile) const { return tiles_[tile].is_next; }
  std::size_t indexOf(std::size_t tile, std::size_t layer) const {  ///< in kDiscs
    return tiles_[tile].indices[layer];
  }

  /// Whether the error of the first layer with its one disc is to be judged by other views
  /// (`TileLens::judges`). It is not where hardly any blur is.
  bool isJudged(std::size_t tile) const {
    return tiles_[tile].indices[0] == 0 && tiles_[tile].is_judged;
  }

  /// Weight of the tile's next image; that of the frame's present image is the rest. It is less
  /// than 1 where an error is little beyond its limit. So a tile does not change abruptly while the
  /// eye moves.
  float weightOf(std::size_t tile) const { return tiles_[tile].weight; }

  /// Gives more discs to the worst tiles, if more than 5 % of the frame's area is beyond the
  /// tolerance, and to tiles that are far beyond it.
  /// @param errors  of the tiles rendered last
  /// @return whether tiles are next
  bool refine(const std::vector<SampledErrors>& errors);

  /// What 95 % of the frame's area stays below, in just-noticeable differences.
  float error() const;

 private:
  using Indices = std::array<std::size_t, TileLayers::kMost>;  ///< in kDiscs, by layer
  struct LayerState {
    std::array<float, SampledErrors::kMost> errors{};  ///< with the tile's indices
    float typical = 0.0f;                              ///< their root mean square
  };
  struct TileState {
    float area_px2 = 0.0f;
    float merging = 0.0f;
    bool is_judged = true;
    float unjudged = 0.0f;  ///< error of a disc that is not judged
    std::array<LayerState, TileLayers::kMost> layers;
    Indices indices{};
    std::array<float, SampledErrors::kMost> of_one{};  ///< errors of a judged disc
    std::size_t samples = 0;                           ///< that have errors
    float typical = 0.0f;                              ///< root mean square of all layers' errors
    float most = 0.0f;                                 ///< no sample's error is larger
    bool is_next = true;
    float weight = 1.0f;  ///< of what is next
  };
  void take(const SampledErrors& sampled, TileState& tile);
  /// What errors of the layers become with other discs, in these.
  using Changes = std::array<float, TileLayers::kMost>;
  static Changes changesOf(const TileState& tile, const Indices& indices);
  /// Of all layers together.
  /// @param error_of  the error of the k-th layer with the tile's indices
  template <typename ErrorOf>
  static float errorAfter(const TileState& tile, const Changes& changes, const ErrorOf& error_of);
  struct Next {
    Indices indices;
    float weight = 0.0f;  ///< 0: the tile stays as it is
  };
  /// The mean of the layers' discs, weighted by the squares of their errors.
  static float discsThatErr(const TileState& tile, const Indices& indices);
  /// One step for all layers: a choice among them would change the tile at once where it changes.
  /// One disc of little error remains: more would change little, and take three times as long.
  static Indices stepFrom(const TileState& tile, Indices indices);
  /// Nothing while the tile's typical error is within the limit, and not far beyond the tolerance;
  /// else more discs, by as many steps as it takes to come near the limit. More discs take time in
  /// proportion to their number n, and remove a share of the squared error e^2. So the tiles of the
  /// largest e^2 / n come first.
  /// @param limit  of e / sqrt(n), in just-noticeable differences
  Next nextWithin(const TileState& tile, float limit) const;
  /// The area with an error beyond `error`, after the steps of `nextWithin`.
  float areaBeyond_px2(float error, float limit) const;

  std::vector<TileState> tiles_;
  float tolerance_ = 1.0f, area_px2_ = 0.0f;
  bool is_first_ = true;  // the next round to judge
};

}  // namespace foci
