// Which nodes of the tree to draw: as coarse as the blur lets them be.
#pragma once

#include <cstdint>
#include <vector>

#include "render/lod/moment_tree.h"
#include "render/optics/defocus.h"
#include "render/optics/view.h"

namespace foci {

/// A node is coarse enough to be drawn while the variance that merging added to it, on the image
/// and the mean of both axes, is at most per_blur2 C^2 + per_pixel2, C its radius of the circle of
/// confusion in pixels.
struct CutSettings {
  float per_blur2;
  float per_pixel2;
};

struct CutEntry {
  std::uint32_t index;
  float weight;  ///< in (0, 1]
};

/// What is drawn instead of all surfels: nodes and surfels of the tree. On the way from the root to
/// each surfel in sight the weights sum to one. A node fades into its children over a range of its
/// size, so that all weights are continuous in view, focus and aperture.
struct Cut {
  std::vector<CutEntry> nodes, surfels;
};

/// Leaves out what cannot touch the image. The same at any number of threads.
void selectCut(const MomentTree& tree, const View& view, const Defocus& defocus,
               const CutSettings& settings, Cut& cut);

}  // namespace foci
