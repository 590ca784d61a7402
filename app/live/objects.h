// Objects of interest by pointing: boxes and spheres in the scene, as `[[scene.object]]` has them.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "app/study/study.h"

namespace foci {

/// A sphere about a point of a surface, 4 degrees wide, with a name that no other has.
/// @param distance_m  to the eye
NamedShape objectAt(const glm::dvec3& point_m, double distance_m,
                    const std::vector<NamedShape>& others);

/// Makes a box of a sphere, and a sphere of a box, of the same width.
void changeKind(NamedShape& shape);

/// The edges of a box, or three circles on a sphere, as lines. Each has two ends.
std::vector<glm::vec3> linesOf(const NamedShape& shape);

}  // namespace foci
