// Points spread over triangles, none closer to another than a given distance.
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

/// Least distance of two points over the spacing wanted: with it, about one point per spacing^2
/// fits.
inline constexpr float kPoissonDistance = 0.8f;

/// Dart throwing (Cook 1986) with many more darts than points, by a fixed seed. Points on sides of
/// a thin sheet that face away from each other do not keep apart.
/// @param corners_m  three a triangle, finite; counter-clockwise as seen from outside
/// @param spacing_m  > 0; area / spacing^2 is at most 10^8 (asserted)
/// @return about area / spacing^2 points; none where no triangle has an area, up to three times as
///   many where triangles are narrower than the spacing
std::vector<MeshPoint> poissonDisk(const std::vector<glm::vec3>& corners_m, double spacing_m);

/// Sum of the triangles' areas.
double areaOf_m2(const std::vector<glm::vec3>& corners_m);

}  // namespace foci
