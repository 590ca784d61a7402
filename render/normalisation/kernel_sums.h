// Sums of the rendered kernels over a scene's surface: how close they are to a partition of unity.
// `foci prepare` reports them.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "render/scene/surfel_cloud.h"

namespace foci {

struct KernelSum {
  float sum;  ///< 1 if the normalisation is perfect
  /// Within the kernels' reach normals agree, points lie in one plane, and there is no border.
  bool smooth;
};

/// The size of pixel and blur over the surfels' local spacing, sqrt(area).
struct SeenAs {
  float pixel_spacings;        ///< side of a pixel, >= 0; 1 on the paper's plane
  float blur_spacings = 0.0f;  ///< blur radius, >= 0
};

/// Sums of the kernels (kernel.h) at points near surfels, spread over the surface by area. The
/// kernels are prefiltered with a variance of one square pixel, and blurred.
/// @param probes    > 0; fewer come back where too many surfels coincide to be counted
/// @param added_m2  the variance along an axis that merging added, for each surfel that is an LOD
///                  node; it makes blurred kernels softer (empty: none)
/// @return          as each of `seen`
std::vector<std::vector<KernelSum>> kernelSums(const SurfelCloud& cloud, std::size_t probes,
                                               std::span<const SeenAs> seen,
                                               std::span<const float> added_m2 = {});
inline std::vector<KernelSum> kernelSums(const SurfelCloud& cloud, std::size_t probes,
                                         const SeenAs& seen, std::span<const float> added_m2 = {}) {
  return kernelSums(cloud, probes, std::span(&seen, 1), added_m2).front();
}

/// The sum of all kernels of the cloud at one place of a flat surface.
/// @param spacing_m  spacing of the surfels there
float kernelSumAt(const SurfelCloud& cloud, const glm::vec3& p_world, float spacing_m,
                  const SeenAs& seen, std::span<const float> added_m2 = {});

/// Share of the sums within 1 +- `tolerance`; 1 if there are none.
double shareWithin(const std::vector<KernelSum>& sums, float tolerance, bool smooth_only);

}  // namespace foci
