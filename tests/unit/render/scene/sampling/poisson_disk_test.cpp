#include "render/scene/sampling/poisson_disk.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace foci {
namespace FOCI_FILE {

constexpr double kCount = 0.12;  // statistical: dart throwing fills more or less of the room

/// Two triangles over [0, 2] x [0, 1] in z = 0, seen from +z.
std::vector<glm::vec3> quad() {
  return {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 0, 0}, {2, 1, 0}, {0, 1, 0}};
}

glm::vec3 at(const std::vector<glm::vec3>& corners, const MeshPoint& point) {
  const glm::vec3 a = corners[3 * point.triangle];
  return a + point.weights.x * (corners[3 * point.triangle + 1] - a) +
         point.weights.y * (corners[3 * point.triangle + 2] - a);
}

TEST(PoissonDisk, KeepsItsSmallestDistanceAndFillsTheSurface) {
  const double spacing = 0.03;
  const auto corners = quad();
  const std::vector<MeshPoint> points = poissonDisk(corners, spacing);
  EXPECT_NEAR(static_cast<double>(points.size()) * spacing * spacing / 2.0, 1.0, kCount);
  // Points on the quad's border stand for less than a whole area: one spacing along its outline.
  const double inner = 2.0 / (static_cast<double>(points.size()) * spacing * spacing);
  EXPECT_NEAR(inner, kPoissonArea, 0.06);
  const float least = kPoissonDistance * static_cast<float>(spacing);
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      ASSERT_GE(glm::distance(at(corners, points[i]), at(corners, points[j])), 0.9999f * least);
    }
  }
  // No hole is much wider than the smallest distance.
  for (int k = 0; k < 400; ++k) {
    const glm::vec3 p(0.1f * static_cast<float>(k % 20) + 0.05f,
                      0.05f * static_cast<float>(k / 20) + 0.025f, 0.0f);
    const bool near = std::any_of(points.begin(), points.end(), [&](const MeshPoint& point) {
      return glm::distance(at(corners, point), p) < 1.6f * least;
    });
    EXPECT_TRUE(near) << p.x << ", " << p.y;
  }
}

TEST(PoissonDisk, IsUniformOverTrianglesOfAnySize) {
  std::vector<glm::vec3> corners = quad();
  for (glm::vec3 p : quad()) corners.push_back(3.0f * p + glm::vec3(0.0f, 0.0f, 5.0f));
  corners.insert(corners.end(), 3, glm::vec3(1.0f));  // no area
  std::size_t small = 0;
  const std::vector<MeshPoint> points = poissonDisk(corners, 0.05);
  for (const MeshPoint& point : points) {
    ASSERT_LT(point.triangle, 4u);
    small += point.triangle < 2;
  }
  EXPECT_NEAR(static_cast<double>(small) / static_cast<double>(points.size()), 0.1, 0.01);
}

TEST(PoissonDisk, FillsBothSidesOfAThinSheet) {
  std::vector<glm::vec3> corners = quad();
  for (const int i : {0, 2, 1, 3, 5, 4}) corners.push_back(quad()[static_cast<std::size_t>(i)]);
  EXPECT_NEAR(static_cast<double>(poissonDisk(corners, 0.05).size()) * 0.0025 / 4.0, 1.0, kCount);
}

TEST(PoissonDisk, HasNothingToFillWithoutAnArea) {
  EXPECT_TRUE(poissonDisk({}, 0.1).empty());
  EXPECT_TRUE(poissonDisk(std::vector<glm::vec3>(6, glm::vec3(1.0f)), 0.1).empty());
}

TEST(PoissonDisk, ASliverTakesNoMoreThanThriceThePointsWanted) {
  const std::vector<glm::vec3> sliver{{0.0f, 0.0f, 0.0f}, {1e4f, 0.0f, 0.0f}, {0.0f, 2e-4f, 0.0f}};
  const std::size_t count = poissonDisk(sliver, std::sqrt(1.0 / 1000.0)).size();
  EXPECT_GE(count, 1000u);
  EXPECT_LE(count, 3000u);
}

TEST(PoissonDisk, ItsFirstPointsAreSpreadOverTheWholeSurface) {
  const auto corners = quad();
  const std::vector<MeshPoint> points = poissonDisk(corners, 0.02);  // about 4500
  const std::size_t first = points.size() / 4;
  std::array<double, 8> counts{};
  for (std::size_t i = 0; i < first; ++i) {
    const glm::vec3 p = at(corners, points[i]);
    counts[4 * static_cast<std::size_t>(p.y >= 0.5f) + std::min(static_cast<int>(2.0f * p.x), 3)] +=
        8.0 / static_cast<double>(first);
  }
  constexpr double kEighth = 0.25;  // statistical: three deviations of 140 independent points
  for (const double count : counts) EXPECT_NEAR(count, 1.0, kEighth);
}

TEST(PoissonDisk, IsTheSameAtAnyNumberOfThreads) {
  const auto make = [](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return poissonDisk(quad(), 0.01);
  };
  const std::vector<MeshPoint> one = make(1), four = make(4);
  ASSERT_EQ(one.size(), four.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    ASSERT_EQ(one[i].triangle, four[i].triangle);
    ASSERT_EQ(one[i].weights, four[i].weights);
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
