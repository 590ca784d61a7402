// Small meshes for the tests of samples and pictures.
#pragma once

#include <glm/glm.hpp>
#include <utility>

#include "render/scene/mesh/orientation.h"
#include "render/scene/mesh/triangle_mesh.h"

namespace foci {

/// A closed box of two triangles a side.
inline void addBox(TriangleMesh& mesh, const glm::vec3& middle_m, const glm::vec3& size_m) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.0f, 1.0f}) {
      const auto corner = [&](float u, float v) {
        glm::vec3 p(0.0f);
        p[axis] = side;
        p[(axis + 1) % 3] = side * u;
        p[(axis + 2) % 3] = v;
        return middle_m + 0.5f * size_m * p;
      };
      const glm::vec3 a = corner(-1, -1), b = corner(1, -1), c = corner(1, 1), d = corner(-1, 1);
      for (const glm::vec3& each : {a, b, c, a, c, d}) mesh.corners_m.push_back(each);
    }
  }
}

/// A mesh of these corners in one colour, with the numbers of its surfaces and bodies.
inline TriangleMesh finishedMesh(TriangleMesh mesh, const glm::vec3& color) {
  mesh.uv.resize(mesh.corners_m.size());
  mesh.material.resize(mesh.size(), 0);
  mesh.materials = {{.texture = nullptr, .factor = color}};
  orientOutwards(mesh);
  return mesh;
}

}  // namespace foci
