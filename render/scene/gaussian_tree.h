// Level of detail for a captured scene: a binary tree of Gaussians merged by their moments.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "render/scene/gaussian_cloud.h"

namespace foci {

/// A perfect binary tree over clusters of 4 to 8 Gaussians, or fewer in a tiny scene. Node i has
/// the children 2 i and 2 i + 1; the root is 1. Each split is at the median along the longest
/// extent of position and size, so that a large Gaussian does not join small ones.
struct GaussianTree {
  /// The merged Gaussians; the first is unused. An opacity above 1 means a flat top (`peakOf`).
  GaussianCloud nodes;
  std::vector<float> radius_m;   ///< by node, of a sphere about its position: holds all to 3 sigma
  std::vector<float> spread_m2;  ///< by node, the variance that merging added (gaussian_merge.h)
  /// By node, share by which the Gaussians' covered area grows for each m^2 of a low-pass.
  std::vector<float> growth_per_m2;
  int levels = 0;  ///< of nodes, >= 1

  bool isCluster(std::size_t node) const { return node >> (levels - 1) != 0; }
};

/// Levels of the tree of `n` Gaussians, n > 0. Its nodes, with the unused first, are 2^levels.
int gaussianTreeLevels(std::size_t n);

/// The cloud in the order of its tree, with the tree. The cloud itself where it has one.
/// Deterministic at any number of threads.
/// @param cloud  not empty, fewer than 2^31
GaussianCloud withTree(GaussianCloud cloud);

/// The cloud itself where it has a tree, which then must outlive the result; else a copy with one.
std::shared_ptr<const GaussianCloud> sharedWithTree(const GaussianCloud& cloud);

}  // namespace foci
