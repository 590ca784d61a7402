// Poisson-disk sampling of triangles: random points with a smallest distance.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace foci {

/// A point of a triangle: corner 0 + weights.x (corner 1 - corner 0) + weights.y (corner 2 - corner
/// 0).
struct MeshPoint {
  std::uint32_t triangle;
  glm::vec2 weights;
};

/// Smallest distance of two points over the wanted spacing. At this value about one point fits into
/// spacing^2; `PoissonDisk` tests check it.
inline constexpr float kPoissonDistance = 0.8f;

/// Mean area of a point over spacing^2: what the darts leave open. Measured on smooth surfaces;
/// `PoissonDisk` tests check it.
inline constexpr double kPoissonArea = 1.107;

/// Dart throwing (Cook 1986) from a fixed seed, with many more darts than points. Points on the two
/// sides of a thin sheet may be closer. The result does not depend on the number of threads.
/// @param corners_m  three for each triangle, finite, less than 2^50 spacings from the origin;
///                   counter-clockwise from outside
/// @param spacing_m  > 0; area / spacing^2 is at most 10^8 (asserted)
/// @return about area / spacing^2 points; none if no triangle has an area, up to three times as
///         many if triangles are narrower than the spacing. The first points are spread over the
///         whole surface.
std::vector<MeshPoint> poissonDisk(const std::vector<glm::vec3>& corners_m, double spacing_m);

/// Sum of the triangles' areas.
double areaOf_m2(const std::vector<glm::vec3>& corners_m);

}  // namespace foci
