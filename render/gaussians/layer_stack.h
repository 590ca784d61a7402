// Composites a tile's layers (tile_layers.h). Each layer has views through discs of its own. What
// lies behind a view is the mean of the next layer's views through nearby discs.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "render/gaussians/composite.h"
#include "render/gaussians/tile_layers.h"
#include "render/gaussians/view_spread.h"

namespace foci {

/// Discs that a layer behind another one is seen through.
struct LensPairs {
  std::vector<LensDisc> behind;
  /// Weights of the views behind, in the mean that lies behind each front view: a row for each view
  /// behind. The weights for a front view sum to 1. All views behind have the same sum.
  std::vector<float> weights;
};

/// Nearby views weigh more. The sums are those of `LensPairs` (Sinkhorn and Knopp 1967).
LensPairs pairLensDiscs(const std::vector<LensDisc>& front, std::vector<LensDisc> behind);

/// Behind the view through a disc lies the view through the same disc.
LensPairs eachWithItself(std::vector<LensDisc> discs);

/// What a tile is rendered through.
struct TileLens {
  const std::vector<LensDisc>* discs = nullptr;  ///< of its first layer
  /// Of each layer with the next.
  std::array<const LensPairs*, TileLayers::kMost - 1> pairs{};
  /// At least three, which judge the error of a first layer with one disc; null: not wanted.
  const std::vector<LensDisc>* judges = nullptr;
  float weight = 1.0f;  ///< of the new image of the tile; that of the frame's is the rest
};

/// Keeps its buffers between tiles.
class LayerStack {
 public:
  /// @param job     of the first layer: its samples
  /// @param errors  null: not wanted
  /// @return kernel evaluations inside of footprints
  std::uint64_t render(const ProjectedGaussian* gaussians, std::span<const std::uint32_t> list,
                       const TileLayers& layers, int apron, const TileLens& lens,
                       const CompositeJob& job, TileSums& sums, SampledErrors* errors);

 private:
  struct Layer {
    TileGaussians gaussians;
    CompositeJob job;
    const std::vector<LensDisc>* discs = nullptr;
    ViewSpread spread;
    bool is_seen = false;
    std::vector<BehindPlanes> samples;  // as each view of the layer before sees it
    std::vector<BehindPlanes> behind;   // the same, at that layer's samples
  };
  const BehindPlanes& behind(std::size_t layer, std::size_t view);
  void composite(std::size_t layer);
  std::function<const BehindPlanes&()> behindOf(std::size_t layer, std::size_t view);
  void judge();
  SampledErrors errors() const;
  BehindSample meanBehind(std::size_t layer, std::size_t place) const;

  TileLayers layers_;
  TileLens lens_;
  std::array<Layer, TileLayers::kMost> stack_;
  ViewSpread judging_;  // of the first layer, if it has one disc
  std::uint64_t fragments_ = 0;
};

}  // namespace foci
