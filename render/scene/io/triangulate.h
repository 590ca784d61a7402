// Cuts polygons into triangles. Private to the readers of meshes.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace foci {

/// Triangles of a polygon, by numbers of its corners, in its winding: ears are cut off in the plane
/// of the polygon (Meisters 1975). A polygon that crosses itself, or has more than 1024 corners,
/// becomes a fan.
std::vector<std::array<std::uint32_t, 3>> triangulate(std::span<const glm::dvec3> corners);

}  // namespace foci
