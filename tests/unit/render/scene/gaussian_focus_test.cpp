// Where the eye focuses in a scene of Gaussians.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/trigonometric.hpp>
#include <optional>
#include <utility>

#include "render/lod/surface_query.h"
#include "tests/unit/render/gaussian_scenes.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kHalfAngle_rad = 0.005, kCoverage = 0.5;
const glm::dvec3 kAhead(0.0, 0.0, -1.0);

std::optional<double> focusIn(GaussianCloud cloud, const glm::dvec3& direction = kAhead) {
  const GaussianCloud& scene = cloud;
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
  EXPECT_NEAR(focusIn(std::move(cloud), aside).value(), expected_m, 1e-3);
}

/// A floor 1.6 m below the eye: one flat Gaussian, its centre 3 m ahead.
GaussianCloud floorBelow() {
  GaussianCloud cloud;
  addGaussian(cloud, {0.0f, -1.6f, -3.0f}, {2.0f, 1e-4f, 2.0f}, 0.98f, glm::vec3(0.5f));
  return cloud;
}

TEST(GaussianFocus, OfALargeFloorIsWhereTheRayMeetsIt) {
  const GaussianCloud scene = floorBelow();
  const SurfaceQuery query(scene);
  for (const double down_deg : {18.0, 25.0, 35.0, 47.0, 60.0}) {
    for (const double aside_deg : {-20.0, 0.0, 15.0}) {
      const double down = glm::radians(down_deg), aside = glm::radians(aside_deg);
      const glm::dvec3 direction(std::cos(down) * std::sin(aside), -std::sin(down),
                                 -std::cos(down) * std::cos(aside));
      const auto distance_m = query.distance(glm::dvec3(0.0), direction, kHalfAngle_rad, 0.05);
      ASSERT_TRUE(distance_m) << down_deg << " " << aside_deg;
      const double expected_m = 1.6 / std::sin(down);
      EXPECT_NEAR(*distance_m, expected_m, 0.01 * expected_m) << down_deg << " " << aside_deg;
    }
  }
}

TEST(GaussianFocus, IsNotOnAFloorAboveItsHorizon) {
  // The Gaussian that is projected at its centre reaches above the horizon. The floor does not.
  const GaussianCloud scene = floorBelow();
  const glm::dvec3 up(0.0, std::sin(0.05), -std::cos(0.05));
  EXPECT_FALSE(SurfaceQuery(scene).distance(glm::dvec3(0.0), up, kHalfAngle_rad, 0.05));
}

TEST(GaussianFocus, IsNotOnAFloorBelowTheEye) {
  // Projected at their centres, which are nearly at right angles to the ray, these fill the view.
  GaussianCloud cloud;
  addGaussian(cloud, {0.0f, 0.0f, -2.0f}, {1.0f, 1.0f, 1e-4f}, 0.97f, glm::vec3(0.5f));
  for (int i = 1; i < 8; ++i) {
    addGaussian(cloud, {0.0f, -0.8f, -0.01f * static_cast<float>(i)}, {0.05f, 0.008f, 0.05f}, 0.97f,
                glm::vec3(0.5f));
  }
  for (const double down : {-0.1, 0.0, 0.1}) {
    const glm::dvec3 direction = glm::normalize(glm::dvec3(0.0, -down, -1.0));
    EXPECT_NEAR(focusIn(cloud, direction).value_or(0.0), 2.0 / -direction.z, 2e-3) << down;
  }
}

TEST(GaussianFocus, OfThinGaussiansAlongTheRayIsAtTheirCentre) {
  // A blade that holds the ray, a needle along it, and a needle beside it, in the cone.
  for (const glm::vec3 sigma_m : {glm::vec3(1e-6f, 0.1f, 0.2f), glm::vec3(1e-6f, 1e-6f, 0.2f)}) {
    for (const float aside_m : {0.0f, 0.002f}) {
      GaussianCloud cloud;
      addGaussian(cloud, {aside_m, 0.0f, -2.0f}, sigma_m, 1.0f, glm::vec3(0.5f));
      const GaussianCloud& scene = cloud;
      const auto distance_m =
          SurfaceQuery(scene).distance(glm::dvec3(0.0), kAhead, kHalfAngle_rad, 1e-9);
      ASSERT_TRUE(distance_m) << sigma_m.y << " " << aside_m;
      EXPECT_NEAR(*distance_m, 2.0, 1e-3) << sigma_m.y << " " << aside_m;
    }
  }
}

/// A square grid of flat Gaussians across the axis, 1 m ahead.
struct Sheet {
  float sigma_m, spacing_m, opacity;

  glm::vec2 place(int column, int row) const {
    return spacing_m *
           glm::vec2(static_cast<float>(column) + 0.33f, static_cast<float>(row) + 0.2f);
  }
  template <typename Take>
  void each(const Take& take) const {
    for (int row = -7; row <= 7; ++row) {
      for (int column = -7; column <= 7; ++column) take(place(column, row));
    }
  }

  /// Mean over the disc that the cone cuts out of the sheet.
  double meanOpacity(double radius_m) const {
    constexpr int kHalf = 40;
    double sum = 0.0, count = 0.0;
    for (int y = -kHalf; y <= kHalf; ++y) {
      for (int x = -kHalf; x <= kHalf; ++x) {
        if (x * x + y * y > kHalf * kHalf) continue;
        const glm::vec2 at = static_cast<float>(radius_m / kHalf) * glm::vec2(x, y);
        double through = 1.0;
        each([&](const glm::vec2& middle) {
          const glm::vec2 d = (at - middle) / sigma_m;
          through *= 1.0 - static_cast<double>(opacity * std::exp(-0.5f * glm::dot(d, d)));
        });
        sum += 1.0 - through;
        count += 1.0;
      }
    }
    return sum / count;
  }
};

TEST(GaussianFocus, OfSeparateOpaqueGaussiansChangesAtTheirMeanOpacity) {
  for (const Sheet& sheet : {Sheet{0.0012f, 0.006f, 0.98f}, Sheet{0.0018f, 0.006f, 0.98f},
                             Sheet{0.0024f, 0.006f, 0.98f}, Sheet{0.0036f, 0.006f, 0.5f},
                             Sheet{0.0024f, 0.0036f, 0.3f}, Sheet{0.0009f, 0.003f, 0.98f}}) {
    GaussianCloud cloud;
    sheet.each([&](const glm::vec2& at) {
      addGaussian(cloud, {at, -1.0f}, {sheet.sigma_m, sheet.sigma_m, 1e-5f}, sheet.opacity,
                  glm::vec3(0.5f));
    });
    const GaussianCloud& scene = cloud;
    const SurfaceQuery query(scene);
    const double mean = sheet.meanOpacity(std::tan(kHalfAngle_rad));
    EXPECT_TRUE(query.distance(glm::dvec3(0.0), kAhead, kHalfAngle_rad, mean - 0.03)) << mean;
    EXPECT_FALSE(query.distance(glm::dvec3(0.0), kAhead, kHalfAngle_rad, mean + 0.03)) << mean;
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
