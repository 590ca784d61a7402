// The LOD cut: the nodes of the tree to render, as coarse as blur and acuity allow.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "render/lod/moment_tree.h"
#include "render/normalisation/kernel_sums.h"
#include "render/optics/acuity.h"
#include "render/optics/defocus.h"
#include "render/optics/view.h"
#include "render/scene/surfel_cloud.h"

namespace foci {

/// Limits on the variance that merging surfels adds to a node. A node may be rendered if that
/// variance, on the image and as the mean of both axes, is at most
///   per_blur2 C^2 + per_pixel2 + per_acuity2 (h^2 - 1).
/// C is the node's blur radius in pixels. h is the prefilter's standard deviation, 1 px at full
/// acuity. Variance along the node's mean normal counts `kThick` times (moment_tree.h). A node of
/// two surfaces is then divided, because the lens sees the two surfaces apart.
struct CutSettings {
  float per_blur2;
  float per_pixel2;
  float per_acuity2 = 0.2f;  ///< nodes up to 1.5 h wide; their Gaussians sum to one within 0.1 %
  /// Variance along the line of sight, which does not show, hardly counts against the last two
  /// terms. False: every node counts as if it faced the eye.
  bool foreshortened = false;
  Acuity acuity = {};
  int margin_px = 0;  ///< keeps nodes that touch the image or this margin about it
  bool operator==(const CutSettings&) const = default;
};

/// Merging adds at most 3 % to the variance of blur and pixel. A square node's spread is side^2 /
/// 12, so a node is at most a quarter of the blur radius wide, or 0.6 px in focus. `SweepLod` and
/// `LevelKernels` tests bound the errors.
inline constexpr CutSettings kFaithfulCut{
    .per_blur2 = 0.0055f, .per_pixel2 = 0.03f, .foreshortened = true};

/// The same where splats are blurred one by one: no node is coarser than pixels allow.
inline constexpr CutSettings kPixelCut{.per_blur2 = 0.0f,
                                       .per_pixel2 = kFaithfulCut.per_pixel2,
                                       .foreshortened = kFaithfulCut.foreshortened};

/// A node fades out over this share of the allowed variance.
inline constexpr float kCutFade = 0.3f;

/// Bounds a kernel's support, standard deviations.
inline constexpr float kWidestReach = 3.0f;

/// Smallest `coarsenessInView` over the coarseness.
inline constexpr float kEdgeOn = 0.612f;

struct CutEntry {
  std::uint32_t index;
  float weight;  ///< in (0, 1]
};

/// Surfels [begin, end) of the tree, each at its full weight.
struct CutRange {
  std::uint32_t begin, end;
};

/// The nodes and surfels to render instead of all surfels, and ranges of surfels where no node is
/// coarse enough. On the path from the root to each visible surfel the weights sum to one. A node
/// fades into its children over a range of its size, so all weights are continuous in view, focus
/// and aperture.
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

/// Smallest and largest distance of the visible part of the tree, measured as `defocus.along` says.
/// Uses nodes of a middle level, so both are exact to about a node's size. Absent if the tree is
/// out of view.
std::optional<std::pair<float, float>> distancesInView(const MomentTree& tree, const View& view,
                                                       const Defocus& defocus);

/// The first node of which all surfels may be taken as one range: a subtree below has at most 512.
std::size_t firstRangeNode(std::size_t surfels);

/// Selects the cut. Leaves out nodes that cannot touch the image or its margin. The result does not
/// depend on the number of threads.
void selectCut(const MomentTree& tree, const View& view, const Defocus& defocus,
               const CutSettings& settings, Cut& cut);

/// The nodes of one tree level as kernels on the surface, for checking that they sum to one.
///
/// A node's weight is the sum of its surfels' areas; no solve is needed. The surfels' kernels are
/// solved to sum to one (render/normalisation/weights.h). A node has the integral, mean and
/// variance of its surfels together. It is rendered only where the variance of blur or prefilter is
/// at least 33 times the variance that merging added. `LevelKernels` tests bound the sums'
/// deviation on a jittered plane. A disc that is sampled by some forty nodes has more ripple, but
/// so it has on a regular grid, where all weights are equal.
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
