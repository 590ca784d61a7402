// The nodes of one tree level as kernels on the surface, for checking that they sum to one.
//
// A node's weight is the sum of its surfels' areas; no solve is needed. The surfels' kernels are
// solved to sum to one (weights.h). A node has the integral, mean and variance of its surfels
// together. It is rendered only where the variance of blur or prefilter is at least 33 times the
// variance that merging added. `LevelKernels` tests bound the sums' deviation on a jittered plane.
// A disc that is sampled by some forty nodes has more ripple, but so it has on a regular grid,
// where all weights are equal.
#pragma once

#include <vector>

#include "render/lod/cut.h"
#include "render/lod/moment_tree.h"
#include "render/normalisation/kernel_sums.h"
#include "render/scene/surfel_cloud.h"

namespace foci {

struct LevelKernels {
  SurfelCloud surfels;          ///< axes from the surfels' own share of the variance
  std::vector<float> added_m2;  ///< variance that merging added, along an axis
};

/// The smallest pixel and the smallest blur that a square node is rendered at, over its side. The
/// side's variance is side^2 / 12, so these are 1 / sqrt(12 per_pixel2) and 1 / sqrt(12 per_blur2)
/// of kFaithfulCut.
inline constexpr SeenAs kCoarsestSharp{1.6667f}, kCoarsestBlurred{0.0f, 3.8925f};

/// @param level  0 (the root) to tree.levels() - 1
LevelKernels levelKernels(const MomentTree& tree, int level);

}  // namespace foci
