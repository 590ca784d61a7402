#include "render/scene/mesh/orientation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <glm/glm.hpp>
#include <random>
#include <utility>

#include "render/scene/mesh/triangle_mesh.h"
#include "tests/cube_mesh.h"

namespace foci {
namespace FOCI_FILE {

void turn(TriangleMesh& mesh, std::size_t triangle) {
  std::swap(mesh.corners_m[3 * triangle + 1], mesh.corners_m[3 * triangle + 2]);
  std::swap(mesh.uv[3 * triangle + 1], mesh.uv[3 * triangle + 2]);
}

/// Triangles from `first` on whose normals point away from `center_m`.
std::size_t outwards(const TriangleMesh& mesh, const glm::vec3& center_m, std::size_t first,
                     std::size_t end) {
  std::size_t count = 0;
  for (std::size_t t = first; t < end; ++t) {
    const glm::vec3* const p = &mesh.corners_m[3 * t];
    count += glm::dot(glm::cross(p[1] - p[0], p[2] - p[0]), p[0] - center_m) > 0.0f;
  }
  return count;
}

constexpr glm::vec3 kCenter(7.0f, -3.0f, 40.0f);

TEST(Orientation, ASolidFacesOutwardsHoweverItWasWound) {
  std::mt19937 random(3);
  for (int part = 0; part <= 4; ++part) {  // quarters of the triangles are turned
    TriangleMesh mesh;
    addCube(mesh, kCenter, 2.0f);
    ASSERT_EQ(outwards(mesh, kCenter, 0, 12), 12u);
    std::size_t turned = 0;
    for (std::size_t t = 0; t < mesh.size(); ++t) {
      if (static_cast<int>(random() % 4) >= part) continue;
      turn(mesh, t);
      ++turned;
    }
    EXPECT_EQ(orientOutwards(mesh), turned);
    EXPECT_EQ(outwards(mesh, kCenter, 0, 12), 12u) << part;
  }
}

TEST(Orientation, TextureFollowsTheCorners) {
  TriangleMesh mesh;
  addCube(mesh, {}, 2.0f);
  for (std::size_t t = 0; t < mesh.size(); ++t) turn(mesh, t);
  orientOutwards(mesh);
  for (std::size_t i = 0; i < mesh.uv.size(); ++i) {
    EXPECT_EQ(mesh.uv[i], glm::vec2(mesh.corners_m[i]));
  }
}

TEST(Orientation, AnOpenSurfaceKeepsTheSideOfMostOfItsArea) {
  TriangleMesh box;  // half a cube: no solid
  addCube(box, kCenter, 2.0f, 3);
  for (std::size_t t = 0; t < box.size(); ++t) turn(box, t);
  turn(box, 2);
  EXPECT_EQ(orientOutwards(box), 1u);
  EXPECT_EQ(outwards(box, kCenter, 0, 6), 0u);
}

TEST(Orientation, ARoomKeepsItsInsideAndItsThingsFaceOutwards) {
  TriangleMesh mesh;
  addCube(mesh, kCenter, 4.0f);
  addCube(mesh, kCenter, 0.5f);
  for (std::size_t t = 0; t < mesh.size(); ++t) turn(mesh, t);
  EXPECT_EQ(orientOutwards(mesh), 12u);
  EXPECT_EQ(outwards(mesh, kCenter, 0, 12), 0u);
  EXPECT_EQ(outwards(mesh, kCenter, 12, 24), 12u);
}

TEST(Orientation, NumbersClosedSurfacesAlone) {
  TriangleMesh mesh;
  addCube(mesh, kCenter, 2.0f);                       // closed
  addCube(mesh, kCenter + glm::vec3(9.0f), 2.0f, 3);  // half a cube
  addCube(mesh, kCenter - glm::vec3(9.0f), 1.0f);     // closed, inside out
  for (std::size_t t = 18; t < mesh.size(); ++t) turn(mesh, t);
  orientOutwards(mesh);
  for (std::size_t t = 0; t < mesh.size(); ++t) {
    EXPECT_EQ(mesh.body[t], t < 12 ? 1 : t < 18 ? 0 : 2) << t;
  }
}

TEST(Orientation, ARoomIsNoClosedBodyAndItsThingsAre) {
  TriangleMesh mesh;
  addCube(mesh, kCenter, 4.0f);
  addCube(mesh, kCenter, 0.5f);
  orientOutwards(mesh);
  EXPECT_EQ(mesh.body[0], 0);
  EXPECT_EQ(mesh.body[12], 1);
}

TEST(Orientation, ASheetOnACubesEdgeOpensIt) {
  TriangleMesh mesh;
  addCube(mesh, {}, 2.0f);
  const glm::vec3 a = mesh.corners_m[0], b = mesh.corners_m[1];
  addTriangle(mesh, a, b, 3.0f * a);  // three triangles share the edge
  orientOutwards(mesh);
  EXPECT_EQ(mesh.body, std::vector<std::uint16_t>(13, 0));
}

TEST(Orientation, AMoebiusStripKeepsASeam) {
  TriangleMesh mesh;
  constexpr int kSteps = 40;
  const auto at = [](int i, float side) {
    const float angle = 6.2831853f * static_cast<float>(i) / kSteps, half = 0.5f * angle;
    const float r = 1.0f + 0.2f * side * std::cos(half);
    return glm::vec3(r * std::cos(angle), r * std::sin(angle), 0.2f * side * std::sin(half));
  };
  for (int i = 0; i < kSteps; ++i) {
    const bool last = i + 1 == kSteps;
    const glm::vec3 c = last ? at(0, 1.0f) : at(i + 1, -1.0f);
    const glm::vec3 d = last ? at(0, -1.0f) : at(i + 1, 1.0f);
    addTriangle(mesh, at(i, -1.0f), c, d);
    addTriangle(mesh, at(i, -1.0f), d, at(i, 1.0f));
  }
  EXPECT_EQ(orientOutwards(mesh), 0u);
}

}  // namespace FOCI_FILE
}  // namespace foci
