#include "render/lod/surface_query.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <glm/gtc/constants.hpp>

#include "render/lod/moment_tree.h"
#include "render/scene/builtin/procedural.h"
#include "render/scene/estimation/estimate.h"
#include "render/scene/io/ply.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kHalfAngle_rad = 0.5 * glm::pi<double>() / 180.0;
constexpr double kFlat = 1e-5;     // relative; float positions, depth weighted in dioptres
constexpr double kSlanted = 2e-3;  // relative; the mean over the cone is not its middle
constexpr double kCurved = 0.01;   // the normal turns by 0.05 rad across the cone
const glm::dvec3 kEye(0.0);
const glm::dvec3 kAhead(0.0, 0.0, -1.0);

/// A sheet across -z, from `low` to `high` (metres), sampled every `step_m`.
void addSheet(SurfelCloud& cloud, float depth_m, glm::vec2 low, glm::vec2 high, float step_m,
              float opacity = 1.0f) {
  const glm::ivec2 count = glm::max(glm::ivec2(glm::round((high - low) / step_m)), 1);
  const glm::vec2 step = (high - low) / glm::vec2(count);
  for (int i = 0; i < count.x * count.y; ++i) {
    const glm::vec2 p = low + (glm::vec2(i % count.x, i / count.x) + 0.5f) * step;
    appendSurfel(cloud, {p, -depth_m}, {0.0f, 0.0f, 1.0f},
                 kSigmaPerSpacing * std::sqrt(step.x * step.y), step.x * step.y, glm::vec3(1.0f),
                 opacity);
  }
}

std::optional<double> ask(const SurfelCloud& cloud, double coverage = 0.5,
                          const glm::dvec3& direction = kAhead) {
  return SurfaceQuery(cloud).distance(kEye, direction, kHalfAngle_rad, coverage);
}

TEST(SurfaceQuery, MeasuresAPlaneAtAnySampling) {
  for (const float step_m : {0.001f, 0.01f, 0.1f}) {
    SurfelCloud cloud;
    const glm::vec2 half(std::max(50.0f * step_m, 0.06f));  // beyond the cone, and its kernels
    addSheet(cloud, 2.0f, -half, half, step_m);
    for (const double coverage : {0.01, 0.5, 1.0}) {
      const auto found = ask(cloud, coverage);
      ASSERT_TRUE(found) << step_m << " m, coverage " << coverage;
      EXPECT_NEAR(*found / 2.0, 1.0, kFlat) << step_m;
    }
  }
}

TEST(SurfaceQuery, MeasuresAlongTheRay) {
  SurfelCloud cloud;
  addSheet(cloud, 1.0f, {-1.0f, -1.0f}, {1.0f, 1.0f}, 0.004f);
  const double angle = 0.6;
  const auto found = ask(cloud, 0.5, {std::sin(angle), 0.0, -std::cos(angle)});
  ASSERT_TRUE(found);
  EXPECT_NEAR(*found * std::cos(angle), 1.0, kSlanted);
}

double sharesOf(const SurfaceHit& hit) {
  double sum = 0.0;
  for (const SurfelShare& each : hit.surfels) sum += each.share;
  return sum;
}

TEST(SurfaceQuery, HitsAPlaneWithItsNormalTowardsTheEye) {
  for (const float side : {1.0f, -1.0f}) {  // a surfel's own normal may point either way
    const glm::vec3 normal = side * glm::normalize(glm::vec3(0.3f, -0.2f, 1.0f));
    const glm::vec3 middle(0.0f, 0.0f, -1.5f);
    const glm::vec3 u = glm::normalize(glm::cross(normal, glm::vec3(0.0f, 1.0f, 0.0f)));
    const glm::vec3 v = glm::cross(normal, u);
    constexpr float kStep_m = 0.005f;
    SurfelCloud cloud;
    for (int i = 0; i < 200 * 200; ++i) {
      const glm::vec2 at = kStep_m * (glm::vec2(i % 200, i / 200) - 99.5f);
      appendSurfel(cloud, middle + at.x * u + at.y * v, normal, kSigmaPerSpacing * kStep_m,
                   kStep_m * kStep_m, glm::vec3(1.0f), 1.0f);
    }
    const glm::dvec3 direction = glm::normalize(glm::dvec3(0.1, 0.15, -1.0));
    const auto hit = SurfaceQuery(cloud).hit(kEye, direction, kHalfAngle_rad, 0.5);
    ASSERT_TRUE(hit);
    const glm::dvec3 towards = static_cast<double>(side) * glm::dvec3(normal);
    const double distance_m = glm::dot(glm::dvec3(middle), towards) / glm::dot(direction, towards);
    EXPECT_NEAR(hit->distance_m / distance_m, 1.0, kSlanted);
    EXPECT_NEAR(glm::distance(hit->normal, towards), 0.0, kFlat);
    EXPECT_NEAR(sharesOf(*hit), 1.0, kFlat);
  }
}

TEST(SurfaceQuery, HitsASphereWhereTheRayDoes) {
  const glm::dvec3 middle(0.1, -0.05, -2.0);
  constexpr double kRadius_m = 0.5;
  constexpr int kSurfels = 100000;
  constexpr double kArea_m2 = 4.0 * glm::pi<double>() * kRadius_m * kRadius_m / kSurfels;
  SurfelCloud cloud;
  for (int i = 0; i < kSurfels; ++i) {  // Fibonacci lattice
    const double y = 1.0 - (2.0 * i + 1.0) / kSurfels;
    const double turn = i * glm::pi<double>() * (3.0 - std::sqrt(5.0));
    const double r = std::sqrt(1.0 - y * y);
    const glm::dvec3 normal(r * std::cos(turn), y, r * std::sin(turn));
    appendSurfel(cloud, glm::vec3(middle + kRadius_m * normal), glm::vec3(normal),
                 kSigmaPerSpacing * static_cast<float>(std::sqrt(kArea_m2)),
                 static_cast<float>(kArea_m2), glm::vec3(1.0f), 1.0f);
  }
  const SurfaceQuery query(cloud);
  for (const glm::dvec2 aim : {glm::dvec2(0.05, -0.025), {0.1, 0.05}, {-0.05, -0.07}}) {
    const glm::dvec3 direction = glm::normalize(glm::dvec3(aim, -1.0));
    const auto hit = query.hit(kEye, direction, kHalfAngle_rad, 0.5);
    ASSERT_TRUE(hit);
    const double along_m = glm::dot(direction, middle);
    const double distance_m =
        along_m - std::sqrt(along_m * along_m - glm::dot(middle, middle) + kRadius_m * kRadius_m);
    EXPECT_NEAR(hit->distance_m / distance_m, 1.0, kSlanted);
    const glm::dvec3 normal = (distance_m * direction - middle) / kRadius_m;
    EXPECT_NEAR(glm::distance(hit->normal, normal), 0.0, kCurved);
    EXPECT_NEAR(sharesOf(*hit), 1.0, kFlat);
  }
  EXPECT_FALSE(query.hit(kEye, {0.0, 0.0, 1.0}, kHalfAngle_rad, 0.5));
}

TEST(SurfaceQuery, SeesAPlaneAtAGrazingAngleAsOneSurface) {
  const SurfelCloud cloud = makePlane(400, 4.0f);
  const double slope = glm::radians(10.0);
  const auto found =
      SurfaceQuery(cloud).distance({0.0, std::sin(slope), std::cos(slope)},
                                   {0.0, -std::sin(slope), -std::cos(slope)}, kHalfAngle_rad, 0.9);
  ASSERT_TRUE(found);
  EXPECT_NEAR(*found, 1.0, 0.01);
}

TEST(SurfaceQuery, MissesWhereNothingIs) {
  SurfelCloud cloud;
  EXPECT_FALSE(ask(cloud));
  addSheet(cloud, 2.0f, {-1.0f, -1.0f}, {1.0f, 1.0f}, 0.01f);
  EXPECT_FALSE(ask(cloud, 0.5, {0.0, 0.0, 1.0}));
  EXPECT_FALSE(ask(cloud, 0.5, {1.0, 0.0, 0.0}));
}

TEST(SurfaceQuery, WeighsHowMuchOfTheConeIsCovered) {
  // The edge of a half-plane at x: the disc's part beyond it, acos(x) - x sqrt(1 - x^2) over pi.
  const auto radius_m = static_cast<float>(std::tan(kHalfAngle_rad));
  for (const float x : {-0.6f, -0.2f, 0.0f, 0.4f}) {
    SurfelCloud cloud;
    addSheet(cloud, 1.0f, {x * radius_m, -0.1f}, {0.1f, 0.1f}, 0.04f * radius_m);
    const double covered = (std::acos(x) - x * std::sqrt(1.0 - x * x)) / glm::pi<double>();
    EXPECT_TRUE(ask(cloud, covered - 0.02)) << "edge at " << x;
    EXPECT_FALSE(ask(cloud, covered + 0.02)) << "edge at " << x;
  }
}

TEST(SurfaceQuery, LooksThroughAWireButNotAtABeam) {
  const auto radius_m = static_cast<float>(std::tan(kHalfAngle_rad));
  // A strip of half width h covers 2 (asin h + h sqrt(1 - h^2)) / pi: half of the cone at h =
  // 0.404.
  for (const auto& [half_width, expected_m] : {std::pair(0.38f, 3.0), std::pair(0.43f, 1.0)}) {
    SurfelCloud cloud;
    addSheet(cloud, 1.0f, {-half_width * radius_m, -0.1f}, {half_width * radius_m, 0.1f},
             0.03f * radius_m);
    addSheet(cloud, 3.0f, {-1.0f, -1.0f}, {1.0f, 1.0f}, 0.01f);
    const auto found = ask(cloud);
    ASSERT_TRUE(found);
    EXPECT_NEAR(*found / expected_m, 1.0, kFlat) << "half width " << half_width;
  }
}

TEST(SurfaceQuery, LooksThroughAFaintMaskButNotAtAStrongOne) {
  for (const auto& [opacity, expected_m] : {std::pair(0.3f, 2.0), std::pair(0.7f, 1.0)}) {
    SurfelCloud cloud;
    addSheet(cloud, 2.0f, {-0.5f, -0.5f}, {0.5f, 0.5f}, 0.01f);
    addSheet(cloud, 1.0f, {-0.5f, -0.5f}, {0.5f, 0.5f}, 0.01f, opacity);
    const auto found = ask(cloud);
    ASSERT_TRUE(found);
    EXPECT_NEAR(*found / expected_m, 1.0, kFlat) << "opacity " << opacity;
  }
}

TEST(SurfaceQuery, DoesNotAddUpSurfacesAtDifferentDepths) {
  SurfelCloud cloud;
  for (const float depth_m : {1.0f, 1.5f, 2.0f})
    addSheet(cloud, depth_m, {-0.2f, -0.2f}, {0.2f, 0.2f}, 0.01f, 0.4f);
  EXPECT_FALSE(ask(cloud));
}

TEST(SurfaceQuery, IgnoresSurfelsThatTouchTheEye) {
  SurfelCloud cloud;
  addSheet(cloud, 0.0005f, {-0.01f, -0.01f}, {0.01f, 0.01f}, 0.001f);
  appendSurfel(cloud, {0.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}, 0.5f, 1.0f, glm::vec3(1.0f));
  addSheet(cloud, 2.0f, {-1.0f, -1.0f}, {1.0f, 1.0f}, 0.01f);
  const auto found = ask(cloud);
  ASSERT_TRUE(found);
  EXPECT_NEAR(*found, 2.0, 2.0 * kFlat);
}

TEST(SurfaceQuery, WorksInsideACloudAndWithAllSurfelsInOnePoint) {
  SurfelCloud ball;
  for (int i = 0; i < 20000; ++i) {
    const float y = 1.0f - (2.0f * static_cast<float>(i) + 1.0f) / 20000.0f;
    const float a = 2.399963f * static_cast<float>(i), r = std::sqrt(1.0f - y * y);
    const glm::vec3 p(r * std::cos(a), y, r * std::sin(a));
    const float area = 4.0f * glm::pi<float>() / 20000.0f;
    appendSurfel(ball, p, p, kSigmaPerSpacing * std::sqrt(area), area, glm::vec3(1.0f));
  }
  const SurfaceQuery query(ball);
  for (const glm::dvec3& d : {kAhead, -kAhead, glm::dvec3(0.6, 0.8, 0.0)}) {
    const auto found = query.distance(kEye, d, kHalfAngle_rad, 0.8);
    ASSERT_TRUE(found);
    EXPECT_NEAR(*found, 1.0, 0.01);
  }
  SurfelCloud point;
  for (int i = 0; i < 100; ++i)
    appendSurfel(point, {0, 0, -1}, {0, 0, 1}, 0.1f, 0.01f, glm::vec3(1.0f));
  EXPECT_TRUE(ask(point));
}

TEST(SurfaceQuery, FindsTheLion) {
  const char* folder = std::getenv("FOCI_DATA");
  const std::filesystem::path data = folder != nullptr ? folder : FOCI_SOURCE_DIR "/../shared/data";
  if (!std::filesystem::exists(data / "scans/lion.ply")) GTEST_SKIP() << "no lion.ply in " << data;
  const SurfelCloud lion = surfelsFromPoints(readPly(data / "scans/lion.ply"));
  const glm::dvec3 eye(-4.4, -1.1, 1.3), target(-2.9, 3.9, -1.2);
  const auto found =
      SurfaceQuery(lion).distance(eye, glm::normalize(target - eye), kHalfAngle_rad, 0.5);
  ASSERT_TRUE(found);
  EXPECT_NEAR(*found, 4.6, 0.6);  // data/README.md: focus at 4.6
}

TEST(SurfaceQuery, TheSceneOwnTreeGivesTheSameDistances) {
  const SurfelCloud cloud = makeGallery();
  const SurfelCloud sorted = withTree(cloud);
  const SurfaceQuery by_order(cloud), by_tree(sorted);
  const EyePose pose = galleryEyePose();
  const glm::dvec3 eye_m(pose.position_m);
  int hits = 0;
  for (const PointOfInterest& point : galleryPointsOfInterest()) {
    for (const double aside : {-0.1, 0.0, 0.1}) {
      const glm::dvec3 to = glm::dvec3(point.p_world) - eye_m;
      const glm::dvec3 direction = glm::normalize(to + glm::dvec3(aside, 0.5 * aside, 0.0));
      const auto a = by_order.distance(eye_m, direction, kHalfAngle_rad, 0.5);
      const auto b = by_tree.distance(eye_m, direction, kHalfAngle_rad, 0.5);
      ASSERT_EQ(a.has_value(), b.has_value());
      if (!a) continue;
      EXPECT_NEAR(*b / *a, 1.0, 1e-3);  // kernels beyond three sigma count or not, by the spheres
      ++hits;
    }
  }
  EXPECT_GT(hits, 10);
}

}  // namespace FOCI_FILE
}  // namespace foci
