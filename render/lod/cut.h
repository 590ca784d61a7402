// Which nodes of the tree to render: as coarse as the blur lets them be.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "render/lod/moment_tree.h"
#include "render/optics/acuity.h"
#include "render/optics/defocus.h"
#include "render/optics/view.h"

namespace foci {

/// A node is coarse enough to be rendered while the variance that merging added to it, on the image
/// and the mean of both axes, is at most
///   per_blur2 C^2 + per_pixel2 + per_acuity2 (h^2 - 1),
/// C its radius of the circle of confusion in pixels and h the prefilter's standard deviation, 1 px
/// at full acuity. Variance along the node's mean normal counts several times: a node that holds
/// two surfaces, which the lens tells apart, comes apart into nodes of one.
struct CutSettings {
  float per_blur2;
  float per_pixel2;
  float per_acuity2 = 0.2f;  ///< nodes up to 1.5 h wide, whose Gaussians sum to one within 0.1 %
  Acuity acuity = {};
};

/// What merging adds to the variance stays within 3 % of the blur's and the pixel's own: a node is
/// at most about a quarter of the blur's radius wide (a square's spread is side^2 / 12), 0.6 px in
/// focus.
inline constexpr CutSettings kFaithfulCut{.per_blur2 = 0.0055f, .per_pixel2 = 0.03f};

struct CutEntry {
  std::uint32_t index;
  float weight;  ///< in (0, 1]
};

/// Surfels [begin, end) of the tree, each at its full weight.
struct CutRange {
  std::uint32_t begin, end;
};

/// What is rendered instead of all surfels: nodes and surfels of the tree, and where none of its
/// nodes can be coarse enough, ranges of surfels. On the way from the root to each surfel in sight
/// the weights sum to one. A node fades into its children over a range of its size, so that all
/// weights are continuous in view, focus and aperture.
struct Cut {
  std::vector<CutEntry> nodes, surfels;
  std::vector<CutRange> ranges;  ///< at most kLongestRange surfels each
  static constexpr std::uint32_t kLongestRange = 4096;

  std::size_t size() const {
    std::size_t sum = nodes.size() + surfels.size();
    for (const CutRange& range : ranges) sum += range.end - range.begin;
    return sum;
  }
};

/// Distances, along what `defocus` says, between which the tree lies in view: of nodes of a middle
/// level, so within about their size. Nothing where it is out of view.
std::optional<std::pair<float, float>> distancesInView(const MomentTree& tree, const View& view,
                                                       const Defocus& defocus);

/// Leaves out what cannot touch the image. The same at any number of threads.
void selectCut(const MomentTree& tree, const View& view, const Defocus& defocus,
               const CutSettings& settings, Cut& cut);

}  // namespace foci
