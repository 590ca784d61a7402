// How many discs of the lens each tile of a frame is rendered through: as few as keep 95 % of the
// frame's pixels below the tolerance.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include "render/gaussians/tile_layers.h"
#include "render/gaussians/view_spread.h"

namespace foci {

/// A number of discs that a tile may be rendered through, and two upper bounds of the error of 95 %
/// of its pixels, in just-noticeable differences: for each px of blur radius, whatever the tile
/// shows, and for each unit of the views' standard error.
///
/// With the error of merging, these bound the errors against 200 pinholes on two captures and on
/// the garden (builtin/garden.cpp). Their blur radii reached 2 to 20 px at the far side, or 4 to
/// 20 px everywhere, at 384 to 1280 px. GaussianCaptures and AutoOnTheChart hold the bound.
struct Discs {
  int count;
  float error_per_px;             ///< of a tile that holds sharp Gaussians, too
  float error_everywhere_per_px;  ///< of a tile that is blurred everywhere
  /// Over the standard error (`SampledErrors`). Views that lie evenly on the lens err less than
  /// random ones: an edge across the lens leaves 0.36, 0.27, 0.24 and 0.17 with 3, 7, 19 and 61
  /// views. The scenes leave more, so the bound is up to 2.5 times as high.
  float error_share;
};
inline constexpr std::array kDiscs{
    Discs{1, 0.5f, 0.9f, 1.0f},       Discs{3, 0.24f, 0.45f, 0.9f},
    Discs{7, 0.09f, 0.22f, 0.66f},    Discs{13, 0.055f, 0.13f, 0.53f},
    Discs{19, 0.038f, 0.08f, 0.42f},  Discs{37, 0.024f, 0.045f, 0.32f},
    Discs{61, 0.017f, 0.032f, 0.26f}, Discs{91, 0.013f, 0.024f, 0.24f}};

/// The bound by the blur radius.
inline float errorOf(const Discs& discs, const TileBlur& blur) {
  return (blur.everywhere ? discs.error_everywhere_per_px : discs.error_per_px) * blur.radius_px;
}

/// Renders in rounds: `choose` once, then render the tiles that `isNext`, and `refine`, until it
/// returns false.
class DiscsOfTiles {
 public:
  /// Gives a tile of one layer one disc where its error is small, else three or more. Each of
  /// several layers gets as many as its blur radius needs: a layer behind takes little time, and
  /// its single views lie far apart.
  /// @param merging  error of a tile's merged Gaussians, in just-noticeable differences
  void choose(std::span<const Tile> tiles, const glm::ivec2& size_px,
              std::span<const TileLayers> layers, std::span<const float> merging, float tolerance);

  bool isNext(std::size_t tile) const { return tiles_[tile].is_next; }
  std::size_t indexOf(std::size_t tile, std::size_t layer) const {  ///< in kDiscs
    return tiles_[tile].indices[layer];
  }

  /// Weight of the tile's next image; that of the frame's present image is the rest. It is less
  /// than 1 where an error is little beyond its limit. So a tile does not change abruptly while the
  /// eye moves.
  float weightOf(std::size_t tile) const { return tiles_[tile].weight; }

  /// Gives more discs to the worst tiles, if more than 5 % of the frame's area is beyond the
  /// tolerance, and to tiles that are far beyond it anywhere.
  /// @param standard_errors  of the tiles rendered last
  /// @return whether tiles are next
  bool refine(const std::vector<SampledErrors>& standard_errors);

  /// What 95 % of the frame's area stays below, in just-noticeable differences.
  float error() const;

 private:
  using Indices = std::array<std::size_t, TileLayers::kMost>;  ///< in kDiscs, by layer
  struct LayerState {
    TileBlur blur;
    float time = 0.0f;     ///< of a disc, in a unit of its own; 0: there is no such layer
    std::size_t last = 0;  ///< no more discs are needed, by the blur radius
    std::array<float, SampledErrors::kMost> errors{};  ///< with the tile's indices
    float typical = 0.0f;                              ///< their root mean square
    float most = 0.0f;                                 ///< the largest of them
  };
  struct TileState {
    float area_px2 = 0.0f;
    float merging = 0.0f;
    std::array<LayerState, TileLayers::kMost> layers;
    Indices indices{};
    std::size_t samples = 0;  ///< that have errors
    bool is_next = true;
    float weight = 1.0f;  ///< of what is next
    bool refined = false;
  };
  void take(const SampledErrors& sampled, TileState& tile);
  /// What errors of a layer become with other discs.
  struct Change {
    std::optional<float> factor;  ///< none: the layer has one disc, and so no spread to judge by
    float bound = 0.0f;
    float of(float error) const { return factor ? std::min(*factor * error, bound) : bound; }
  };
  using Changes = std::array<Change, TileLayers::kMost>;
  static Change changeOf(const TileState& tile, std::size_t layer, std::size_t index);
  static Changes changesOf(const TileState& tile, const Indices& indices);
  /// Of all layers together.
  /// @param error_of  the error of a layer with the tile's indices
  template <typename ErrorOf>
  static float errorAfter(const Changes& changes, const TileState& tile, const ErrorOf& error_of);
  struct Next {
    Indices indices;
    float weight = 0.0f;  ///< 0: the tile stays as it is
  };
  /// Nothing while the tile's typical error is within the limit, and no error is far beyond the
  /// tolerance; else the discs with the least time with which they are.
  Next nextWithin(const TileState& tile, float limit) const;
  /// The area with an error beyond `error`, if each typical error becomes at most the limit.
  float areaBeyond_px2(float error, float limit) const;

  std::vector<TileState> tiles_;
  float tolerance_ = 1.0f, area_px2_ = 0.0f;
};

}  // namespace foci
