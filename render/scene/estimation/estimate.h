// From points to surfels: the normals, sizes and areas that the points do not bring along.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <optional>

#include "render/scene/point_cloud.h"
#include "render/scene/surfel_cloud.h"

namespace foci {

enum class KernelSolve {
  none,   ///< areas are spacing^2
  quick,  ///< areas
  /// Sizes as well as areas, so that the kernels of an irregular sampling sum to one much more
  /// closely: about fifteen times the work, surfels a third larger, and 350 bytes a surfel while it
  /// works.
  thorough,
};

struct EstimateSettings {
  /// Estimated normals are turned towards it; by default away from the cloud's centroid. Splats are
  /// drawn two-sided, so this only matters to shading.
  std::optional<glm::vec3> viewpoint_m = {};
  float lone_spacing_m = 0.01f;  ///< spacing where there is no neighbour to measure one by
  KernelSolve solve = KernelSolve::quick;
  std::function<void(std::size_t done, std::size_t total)> progress = {};  ///< where thorough
};

/// Sigma of a surfel over the radius that a file gives: a disc that just reaches across the gaps of
/// a square grid has spacing / sqrt(2).
inline constexpr float kSigmaPerRadius = kSigmaPerSpacing * 1.41421356f;

/// Surfels of points sampled on surfaces, in Morton order (neighbours in space are near in memory),
/// not the points' own.
///   normal: the given one, else the least axis of the nearest neighbours (PCA, Hoppe et al. 1992);
///   spacing: sqrt(pi r_k^2 / k), r_k the distance of the k-th neighbour; at most a few times the
///            median, so that strays stay small;
///   sigma:  kSigmaPerRadius radius where given, else kSigmaPerSpacing spacing;
///   area:   starts at spacing^2, then is solved so that the kernels sum to one (weights.h).
/// Deterministic at any number of threads. Points that coincide share their area. Any input, one
/// point included, gives finite axes and areas > 0.
SurfelCloud surfelsFromPoints(PointCloud&& points, const EstimateSettings& settings = {});

}  // namespace foci
