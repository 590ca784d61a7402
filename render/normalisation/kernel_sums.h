// How closely a scene's kernels sum to one over its surface, as they are rendered: what `foci
// prepare` reports.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "render/scene/surfel_cloud.h"

namespace foci {

struct KernelSum {
  float sum;    ///< 1 where the normalisation is perfect
  bool smooth;  ///< a smooth part: as far as kernels reach normals agree, points lie in one plane,
                ///< and there is no border
};

/// How large surfels are on the image. In units of their local spacing, sqrt(area).
struct SeenAs {
  float pixel_spacings;        ///< side of a pixel, >= 0: 1 as on the paper's plane
  float blur_spacings = 0.0f;  ///< radius of the circle of confusion, >= 0
};

/// Sums of the kernels (kernel.h), prefiltered as a pixel does (variance of one square pixel) and
/// blurred, at points spread over the surface by area, beside the surfels.
/// @param probes    > 0; fewer come back where so many surfels coincide that counting them is
///                  pointless
/// @param added_m2  for each surfel that is a node of a level of detail: the variance along an axis
///                  that merging added, for which blurred kernels are softer; empty: none
std::vector<KernelSum> kernelSums(const SurfelCloud& cloud, std::size_t probes, const SeenAs& seen,
                                  std::span<const float> added_m2 = {});

/// The sum at one place of a surface that is flat: all kernels, wherever they are.
/// @param spacing_m  of the surfels there
float kernelSumAt(const SurfelCloud& cloud, const glm::vec3& p_world, float spacing_m,
                  const SeenAs& seen, std::span<const float> added_m2 = {});

/// Share of the sums within 1 +- `tolerance`; 1 where there are none.
double shareWithin(const std::vector<KernelSum>& sums, float tolerance, bool smooth_only);

}  // namespace foci
