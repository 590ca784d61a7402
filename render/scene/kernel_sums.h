// How closely a scene's kernels sum to one over its surface: what `foci prepare` reports.
#pragma once

#include <cstddef>
#include <vector>

#include "render/scene/surfel_cloud.h"

namespace foci {

struct KernelSum {
  float sum;    ///< 1 where the normalisation is perfect
  bool smooth;  ///< a smooth part: around it normals agree, points lie in one plane, and there is
                ///< no border
};

/// Sums of the kernels, prefiltered as a pixel does (variance of one square pixel), at points
/// spread over the surface by area, beside the surfels.
/// @param probes           > 0; fewer come back where so many surfels coincide that counting them
/// is pointless
/// @param pixel_spacings   side of a pixel over the local spacing of surfels, >= 0: 1 as on the
/// paper's plane,
///                         0.5 seen from half as far
std::vector<KernelSum> kernelSums(const SurfelCloud& cloud, std::size_t probes,
                                  float pixel_spacings);

/// Share of the sums within 1 +- `tolerance`; 1 where there are none.
double shareWithin(const std::vector<KernelSum>& sums, float tolerance, bool smooth_only);

}  // namespace foci
