// Meshes of cubes for tests.
#pragma once

#include <glm/glm.hpp>

#include "render/scene/mesh/triangle_mesh.h"

namespace foci {

inline void addTriangle(TriangleMesh& mesh, const glm::vec3& a, const glm::vec3& b,
                        const glm::vec3& c) {
  for (const glm::vec3& corner : {a, b, c}) {
    mesh.corners_m.push_back(corner);
    mesh.uv.emplace_back(corner.x, corner.y);
  }
  mesh.material.push_back(0);
}

/// The corner (x, y, z) of a cube, each 0 or 1.
inline glm::vec3 cornerOf(const glm::vec3& center_m, float side_m, int x, int y, int z) {
  return center_m + side_m * (glm::vec3(x, y, z) - 0.5f);
}

/// Wound counter-clockwise from outside. `faces` leaves some out from the end.
inline void addCube(TriangleMesh& mesh, const glm::vec3& center_m, float side_m, int faces = 6) {
  for (int face = 0; face < faces; ++face) {
    const int axis = face % 3, high = face / 3;
    glm::vec3 corners[4];
    for (int k = 0; k < 4; ++k) {
      int place[3];
      place[axis] = high;
      place[(axis + 1) % 3] = k == 1 || k == 2;
      place[(axis + 2) % 3] = k >= 2;
      corners[high == 1 ? k : 3 - k] = cornerOf(center_m, side_m, place[0], place[1], place[2]);
    }
    addTriangle(mesh, corners[0], corners[1], corners[2]);
    addTriangle(mesh, corners[0], corners[2], corners[3]);
  }
}

}  // namespace foci
