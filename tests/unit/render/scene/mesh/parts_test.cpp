// Samples of a mesh of several connected parts.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "render/scene/mesh/sample_mesh.h"
#include "tests/unit/render/mesh_shapes.h"

namespace foci {
namespace FOCI_FILE {

TriangleMesh boxes(std::size_t small_ones, float small_m) {
  TriangleMesh mesh;
  addBox(mesh, glm::vec3(0.0f), glm::vec3(4.0f));
  for (std::size_t i = 0; i < small_ones; ++i) {
    addBox(mesh, {3.0f, 0.0f, 2.0f * small_m * static_cast<float>(i)}, glm::vec3(small_m));
  }
  return finishedMesh(std::move(mesh), {0.6f, 0.4f, 0.2f});
}

/// Mean distance of the points of the large box, and of the others.
struct Spacings {
  double large_m, small_m;
};

Spacings spacingsOf(const PointCloud& points, std::size_t small_ones, float small_m) {
  double large = 0.0, small = 0.0;
  for (const glm::vec3& p : points.position_m) (p.x > 2.5f ? small : large) += 1.0;
  const double area_m2 = 6.0 * static_cast<double>(small_m * small_m);
  return {std::sqrt(96.0 / large), std::sqrt(static_cast<double>(small_ones) * area_m2 / small)};
}

TEST(PartsOfAMesh, ASmallPartHasMorePoints) {
  const PointCloud points = sampleMesh(boxes(1, 0.1f), "boxes");
  const Spacings seen = spacingsOf(points, 1, 0.1f);
  EXPECT_NEAR(seen.large_m, 0.0146, 0.001);       // half a million points
  EXPECT_LE(seen.small_m, 0.1732 / 200.0 * 1.1);  // the box's diagonal over 200 rows
  EXPECT_GE(seen.small_m, 0.1732 / 200.0 / 2.2);
  // The shares are those of the spacing at each point.
  double area_m2 = 0.0;
  for (const float each : points.area_m2) area_m2 += double{each};
  EXPECT_NEAR(area_m2, 96.06, 0.05 * 96.06);
}

TEST(PartsOfAMesh, AMeshOfOnePartHasOneSpacing) {
  const PointCloud points = sampleMesh(boxes(0, 0.1f), "box");
  for (const float each : points.area_m2) EXPECT_EQ(each, points.area_m2[0]);
}

TEST(PartsOfAMesh, AWantedNumberCountsThePointsOfSmallParts) {
  for (const std::size_t wanted : {20'000u, 100'000u, 700'000u}) {
    const PointCloud points = sampleMesh(boxes(1, 0.5f), "boxes", {.points = wanted});
    EXPECT_GE(points.size(), wanted / 2);
    EXPECT_LE(points.size(), wanted * 11 / 10);
    const Spacings seen = spacingsOf(points, 1, 0.5f);
    EXPECT_LT(seen.small_m, 0.6 * seen.large_m) << wanted;
  }
}

// Parts get fewer points each, the more there are.
TEST(PartsOfAMesh, ManyPartsDoNotExplode) {
  const PointCloud points = sampleMesh(boxes(400, 0.1f), "boxes");
  EXPECT_LE(points.size(), 2'200'000u);
  const Spacings seen = spacingsOf(points, 400, 0.1f);
  EXPECT_LT(seen.small_m, 0.6 * seen.large_m);
}

}  // namespace FOCI_FILE
}  // namespace foci
