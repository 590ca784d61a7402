// The nodes of one level of detail as kernels on the surface, to be summed over it.
//
// A node's weight is the sum of its surfels' areas, and that suffices: the surfels' kernels are
// solved to sum to one (weights.h), a node has the same integral, mean and variance as those of its
// surfels together, and it is rendered where the variance of blur or prefilter is at least 33 times
// what merging added. On a jittered plane the sums' standard deviation is then below 0.2 % in focus
// at every level, less than the surfels' own. Where a disc is sampled by some forty nodes it is
// 0.9 %, but so it is on a regular grid, where all weights are equal: no weights could better that.
#pragma once

#include <vector>

#include "render/lod/cut.h"
#include "render/lod/moment_tree.h"
#include "render/normalisation/kernel_sums.h"
#include "render/scene/surfel_cloud.h"

namespace foci {

struct LevelKernels {
  SurfelCloud surfels;          ///< as rendered: the axes are the share of the variance that is own
  std::vector<float> added_m2;  ///< variance along an axis that merging added
};

/// The finest pixel and the least blur that square nodes are rendered at, in units of their side,
/// whose variance is side^2 / 12: 1 / sqrt(12 per_pixel2) and 1 / sqrt(12 per_blur2) of
/// kFaithfulCut.
inline constexpr SeenAs kCoarsestSharp{1.6667f}, kCoarsestBlurred{0.0f, 3.8925f};

/// @param level  0 (the root) to tree.levels() - 1
LevelKernels levelKernels(const MomentTree& tree, int level);

}  // namespace foci
