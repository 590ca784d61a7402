// The LOD cut of a captured scene: the nodes of its tree to render, as coarse as the blur allows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "render/optics/acuity.h"
#include "render/optics/defocus.h"
#include "render/optics/view.h"
#include "render/scene/gaussian_tree.h"

namespace foci {

/// The limit of the variance that merging adds to a rendered node, on the image:
///   min(per_blur2 C^2, max_px2) + per_pixel2 + per_acuity2 (h^2 - 1).
/// C is the least blur radius within the node. h is the acuity's least standard deviation, 1 px
/// where detail is resolved in full.
struct GaussianCutSettings {
  float per_blur2;
  float max_px2 = std::numeric_limits<float>::infinity();
  float per_pixel2 = 0.03f;  ///< a tenth of the low-pass
  float per_acuity2 = 0.2f;  ///< as for surfels (cut.h)
  Acuity acuity = {};
};

/// How far the low-pass reaches on the image.
inline constexpr float kLowPassReach_px = 4.0f;

/// Nodes and single Gaussians that together are the scene. Each Gaussian in view is in exactly one.
struct GaussianCut {
  std::vector<std::uint32_t> nodes, gaussians;
  std::size_t size() const { return nodes.size() + gaussians.size(); }
};

/// Selects the cut. Leaves out nodes that cannot touch the image through any point of the lens. The
/// result does not depend on the number of threads.
/// @param cloud  with its tree (asserted)
void selectCut(const GaussianCloud& cloud, const View& view, const Defocus& defocus,
               const GaussianCutSettings& settings, GaussianCut& cut);

}  // namespace foci
