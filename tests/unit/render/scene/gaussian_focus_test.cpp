// Where the eye focuses in a scene of Gaussians.
#include <gtest/gtest.h>

#include "render/lod/surface_query.h"
#include "tests/unit/render/gaussian_scenes.h"

namespace foci {
namespace {

constexpr double kHalfAngle_rad = 0.005, kCoverage = 0.5;
const glm::dvec3 kAhead(0.0, 0.0, -1.0);

std::optional<double> focusIn(GaussianCloud cloud, const glm::dvec3& direction = kAhead) {
  const SurfelCloud scene = sceneOf(std::move(cloud));
  return SurfaceQuery(scene).distance(glm::dvec3(0.0), direction, kHalfAngle_rad, kCoverage);
}

GaussianCloud wallAt2m() {
  GaussianCloud cloud;
  addWall(cloud, 2.0f, 1.0f, 40, 0.95f, glm::vec3(0.5f));
  return cloud;
}

TEST(GaussianFocus, IsOnAWall) {
  EXPECT_NEAR(focusIn(wallAt2m()).value(), 2.0, 1e-3);
  EXPECT_FALSE(focusIn(wallAt2m(), {0.0, 0.0, 1.0}));
  EXPECT_FALSE(focusIn(wallAt2m(), glm::normalize(glm::dvec3(1.0, 0.0, -1.0))));
}

TEST(GaussianFocus, AThinVeilDoesNotCatchIt) {
  for (const float opacity : {0.1f, 0.3f, 0.9f}) {
    GaussianCloud cloud = wallAt2m();
    // A veil as wide as the cone and wider: its opacity is that of the cone.
    addGaussian(cloud, {0.0f, 0.0f, -1.0f}, {0.2f, 0.2f, 0.01f}, opacity, glm::vec3(0.5f));
    EXPECT_NEAR(focusIn(std::move(cloud)).value(), opacity > 0.5f ? 1.0 : 2.0, 1e-3) << opacity;
  }
}

TEST(GaussianFocus, SeveralVeilsTogetherDo) {
  // 1 - 0.7^2 = 0.51 is opaque enough at the second veil.
  GaussianCloud cloud = wallAt2m();
  for (const float depth_m : {1.0f, 1.5f}) {
    addGaussian(cloud, {0.0f, 0.0f, -depth_m}, {0.2f, 0.2f, 0.01f}, 0.305f, glm::vec3(0.5f));
  }
  EXPECT_NEAR(focusIn(std::move(cloud)).value(), 1.5, 1e-3);
}

TEST(GaussianFocus, ASpeckSmallerThanTheConeDoesNotCatchIt) {
  GaussianCloud cloud = wallAt2m();
  addGaussian(cloud, {0.0f, 0.0f, -1.0f}, glm::vec3(0.0005f), 1.0f, glm::vec3(0.5f));
  EXPECT_NEAR(focusIn(std::move(cloud)).value(), 2.0, 1e-3);
}

TEST(GaussianFocus, OfASlantedSheetIsWhereTheRayMeetsIt) {
  // A large flat Gaussian at 45 degrees about y: at the offset x its depth changes by x.
  GaussianCloud cloud;
  const float half = 0.25f * 3.14159265f;
  addGaussian(cloud, {0.0f, 0.0f, -2.0f}, {0.5f, 0.5f, 1e-4f}, 0.99f, glm::vec3(0.5f),
              {0.0f, std::sin(0.5f * half), 0.0f, std::cos(0.5f * half)});
  // The rotation takes x to (cos 45, 0, -sin 45): to the right the sheet is farther away.
  const glm::dvec3 aside = glm::normalize(glm::dvec3(0.05, 0.0, -1.0));
  const double expected_m = 2.0 / (1.0 - 0.05) * std::hypot(1.0, 0.05);
  // The affine approximation leaves out squares of the offset.
  EXPECT_NEAR(focusIn(std::move(cloud), aside).value(), expected_m, 0.05 * 0.05 * 2.0 * 2.0);
}

}  // namespace
}  // namespace foci
