// Estimates surfels from points: the normals, sizes and areas that a file does not give.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <optional>

#include "render/scene/point_cloud.h"
#include "render/scene/surfel_cloud.h"

namespace foci {

/// How to solve the surfels' areas so that their kernels are a partition of unity (weights.h).
enum class KernelSolve {
  none,   ///< areas are spacing^2
  quick,  ///< solves areas
  /// Solves areas and sizes, for an irregular sampling. Takes about ten times as long, and 500
  /// bytes a surfel while it works; surfels become a third larger.
  thorough,
};

struct EstimateSettings {
  /// Estimated normals point towards this place; by default, away from the cloud's centroid. Splats
  /// are two-sided, so this matters for shading only.
  std::optional<glm::vec3> viewpoint_m = {};
  float lone_spacing_m = 0.01f;  ///< spacing of a point without neighbours
  KernelSolve solve = KernelSolve::quick;
  std::function<void(std::size_t done, std::size_t total)> progress = {};  ///< called if thorough
  /// Points in one part of space, > 0: their neighbours take half a kilobyte each.
  std::size_t solved_at_once = std::size_t{1} << 19;
  /// Called if thorough, with the surfels before they are solved; one for all points that coincide.
  std::function<void(const SurfelCloud&)> unsolved = {};
};

/// Sigma of a surfel over the radius that a file gives. A disc that just closes the gaps of a
/// square grid has the radius spacing / sqrt(2).
inline constexpr float kSigmaPerRadius = kSigmaPerSpacing * 1.41421356f;

/// Estimates one surfel from each point sampled on a surface. Surfels come in Morton order, so that
/// neighbours in space are near in memory.
///
///   normal:  the given one; else the smallest principal axis of the nearest neighbours (PCA, Hoppe
///            et al. 1992)
///   spacing: sqrt(pi r_k^2 / k), with the distance r_k of the k-th neighbour; at most a few times
///            the median, so that stray points stay small
///   sigma:   kSigmaPerRadius radius if given, else kSigmaPerSpacing spacing
///   area:    spacing^2, then solved so that the kernels sum to one (weights.h)
///
/// Points that coincide share their area. Any input, even one point, gives finite axes and areas >
/// 0. The result does not depend on the number of threads.
SurfelCloud surfelsFromPoints(PointCloud&& points, const EstimateSettings& settings = {});

}  // namespace foci
