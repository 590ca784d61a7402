#include "render/literature/paper/hierarchy.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>

#include "tests/unit/render/surfel_scenes.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kSumTolerance = 1e-5;  // float sums along a tree, of some thousand terms
constexpr float kRounding = 1e-5f;      // relative, of lengths and their squares

TEST(PaperHierarchy, EveryLevelHasTheSameArea) {
  for (int n : {1, 2, 3, 4, 5, 16, 17, 1000, 4097}) {
    const SurfelCloud cloud = scattered(n, 1, false);
    double area_m2 = 0.0;
    for (const float a : cloud.area_m2) area_m2 += a;
    const PaperHierarchy hierarchy(cloud);
    for (int l = 0; l < hierarchy.levels(); ++l) {
      double sum_m2 = 0.0;
      for (const PaperNode& node : hierarchy.level(l)) sum_m2 += node.area_m2;
      EXPECT_NEAR(sum_m2 / area_m2, 1.0, kSumTolerance) << n << " surfels, level " << l;
    }
  }
}

TEST(PaperHierarchy, EverySurfelIsInOneNodeOfEachLevelAndInItsSphere) {
  for (int n : {1, 4, 5, 17, 3001}) {
    const SurfelCloud cloud = scattered(n, 2, false);
    const PaperHierarchy hierarchy(cloud);
    std::vector<std::uint32_t> sorted = hierarchy.order();
    std::sort(sorted.begin(), sorted.end());
    ASSERT_EQ(sorted.size(), cloud.size());
    for (std::size_t i = 0; i < sorted.size(); ++i) ASSERT_EQ(sorted[i], i);
    for (int l = 0; l < hierarchy.levels(); ++l) {
      std::size_t next = 0;
      for (std::size_t node = 0; node < hierarchy.level(l).size(); ++node) {
        const auto [begin, end] = hierarchy.surfels(l, node);
        ASSERT_EQ(begin, next);
        ASSERT_GT(end, begin);
        if (l + 1 == hierarchy.levels()) {
          ASSERT_LE(end - begin, 4u);
        }
        next = end;
        const PaperNode& sphere = hierarchy.level(l)[node];
        for (std::size_t i = begin; i < end; ++i) {
          const std::uint32_t surfel = hierarchy.order()[i];
          const float disc_m = std::sqrt(cloud.area_m2[surfel] * std::numbers::inv_pi_v<float>);
          EXPECT_LE(glm::length(cloud.position_m[surfel] - sphere.center_m) + disc_m,
                    sphere.radius_m * (1.0f + kRounding));
        }
      }
      EXPECT_EQ(next, cloud.size());
    }
  }
}

TEST(PaperHierarchy, SpheresShrinkWithTheSurfaceOfTheirNode) {
  // In a square of n surfels, a node of level l covers 1 / 4^l of the area and is nearly square.
  SurfelCloud cloud;
  addSheetOf(cloud, {.side_m = 1.0f, .samples = 128});
  const PaperHierarchy hierarchy(cloud);
  for (int l = 0; l < hierarchy.levels(); ++l) {
    const float diagonal_m = std::sqrt(2.0f) * std::ldexp(1.0f, -l);
    for (const PaperNode& node : hierarchy.level(l)) {
      EXPECT_LT(2.0f * node.radius_m, 1.1f * diagonal_m) << "level " << l;
    }
  }
}

TEST(PaperHierarchy, BasisOfAFlatNodeIsTheSurfelsBasisPlusTheirSpread) {
  // On an m x m grid of spacing h, the variance of the positions along an axis is h^2 (m^2 - 1)
  // / 12.
  constexpr int kSide = 16;
  SurfelCloud cloud;
  addSheetOf(cloud, {.side_m = 1.6f, .samples = kSide, .color = {0.25f, 0.5f, 1.0f}});
  const PaperNode root = PaperHierarchy(cloud).level(0)[0];
  const float own_m2 = kSigmaPerSpacing * kSigmaPerSpacing * 0.01f;
  const float spread_m2 = 0.01f * (kSide * kSide - 1.0f) / 12.0f;
  for (const glm::vec3& axis : {glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1)}) {
    const float flat = axis.z == 0.0f ? 1.0f : 0.0f;
    const auto variance = [&](const glm::vec3& u, const glm::vec3& v) {
      return glm::dot(axis, u) * glm::dot(axis, u) + glm::dot(axis, v) * glm::dot(axis, v);
    };
    EXPECT_NEAR(variance(root.axis_u_m, root.axis_v_m), flat * own_m2, kRounding * own_m2);
    EXPECT_NEAR(variance(root.spread_u_m, root.spread_v_m), flat * spread_m2,
                kRounding * spread_m2);
  }
  EXPECT_NEAR(glm::length(root.position_m - glm::vec3(0, 0, -1)), 0.0f, kRounding);
  EXPECT_NEAR(glm::length(root.color - glm::vec3(0.25f, 0.5f, 1.0f)), 0.0f, kRounding);
}

TEST(PaperHierarchy, ColoursAreMeansByAreaAndOpacity) {
  SurfelCloud cloud;
  appendSurfel(cloud, {0, 0, 0}, {0, 0, 1}, 0.1f, 1.0f, {1, 0, 0}, 1.0f);
  appendSurfel(cloud, {1, 0, 0}, {0, 0, 1}, 0.1f, 2.0f, {0, 1, 0}, 0.5f);
  appendSurfel(cloud, {2, 0, 0}, {0, 0, 1}, 0.1f, 1.0f, {0, 0, 1}, 0.0f);
  const PaperNode root = PaperHierarchy(cloud).level(0)[0];
  EXPECT_NEAR(glm::length(root.color - glm::vec3(0.5f, 0.5f, 0.0f)), 0.0f, kRounding);
  EXPECT_NEAR(root.opacity, 0.5f, kRounding);
  EXPECT_NEAR(root.position_m.x, 1.0f, kRounding);
}

TEST(PaperHierarchy, NormalsOfOppositeSignAgree) {
  SurfelCloud cloud;
  for (int i = 0; i < 16; ++i) {
    const float sign = i % 2 == 0 ? 1.0f : -1.0f;
    appendSurfel(cloud, {0.1f * static_cast<float>(i % 4), 0.1f * static_cast<float>(i / 4), 0.0f},
                 {0.0f, 0.0f, sign}, 0.05f, 0.01f, glm::vec3(1.0f));
  }
  const PaperNode root = PaperHierarchy(cloud).level(0)[0];
  const glm::vec3 normal = glm::normalize(glm::cross(root.axis_u_m, root.axis_v_m));
  EXPECT_NEAR(std::abs(normal.z), 1.0f, kRounding);
}

TEST(PaperHierarchy, LeavesOutSurfelsThatAreNeverVisible) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  SurfelCloud cloud;
  const glm::vec3 up(0, 0, 1), white(1.0f);
  appendSurfel(cloud, {nan, 0, 0}, up, 0.1f, 0.01f, white);
  appendSurfel(cloud, {0, inf, 0}, up, 0.1f, 0.01f, white);
  appendSurfel(cloud, {0, 0, 0}, up, nan, 0.01f, white);
  appendSurfel(cloud, {0, 0, 0}, up, 0.0f, 0.01f, white);
  appendSurfel(cloud, {0, 0, 0}, up, 0.1f, 0.0f, white);
  appendSurfel(cloud, {0, 0, 0}, up, 0.1f, nan, white);
  EXPECT_EQ(PaperHierarchy(cloud).levels(), 0);
  appendSurfel(cloud, {0, 0, 0}, up, 0.1f, 0.01f, white);
  EXPECT_EQ(PaperHierarchy(cloud).order(), std::vector<std::uint32_t>{6});
}

TEST(PaperHierarchy, SurfelsAtOnePointAreAPoint) {
  SurfelCloud cloud;
  for (int i = 0; i < 1000; ++i) {
    appendSurfel(cloud, {1, 2, 3}, {0, 0, 1}, 0.1f, 0.01f, glm::vec3(1.0f));
  }
  const PaperHierarchy hierarchy(cloud);
  const PaperNode root = hierarchy.level(0)[0];
  EXPECT_EQ(root.position_m, glm::vec3(1, 2, 3));
  EXPECT_EQ(root.spread_u_m, glm::vec3(0.0f));
  EXPECT_EQ(root.spread_v_m, glm::vec3(0.0f));
  EXPECT_NEAR(root.area_m2, 10.0, 10.0 * kSumTolerance);
}

TEST(PaperHierarchy, SizesABillionToOneStayFinite) {
  SurfelCloud cloud;
  for (int i = 0; i < 300; ++i) {
    const float sigma_m = std::pow(10.0f, -8.0f + 9.0f * static_cast<float>(i) / 299.0f);
    appendSurfel(cloud, {sigma_m, 0.01f * static_cast<float>(i), 0}, {0, 0, 1}, sigma_m,
                 sigma_m * sigma_m, glm::vec3(1.0f));
  }
  const PaperHierarchy hierarchy(cloud);
  for (int l = 0; l < hierarchy.levels(); ++l) {
    for (const PaperNode& node : hierarchy.level(l)) {
      EXPECT_TRUE(std::isfinite(node.radius_m));
      EXPECT_GT(glm::length(glm::cross(node.axis_u_m, node.axis_v_m)), 0.0f);
      EXPECT_GT(node.area_m2, 0.0f);
    }
  }
}

TEST(PaperHierarchy, IsTheSameAtAnyNumberOfThreads) {
  const SurfelCloud cloud = scattered(20000, 3, true);
  const auto on = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return PaperHierarchy(cloud);
  };
  const PaperHierarchy one = on(1), many = on(4);
  EXPECT_EQ(one.order(), many.order());
  ASSERT_EQ(one.levels(), many.levels());
  for (int l = 0; l < one.levels(); ++l) {
    EXPECT_EQ(std::memcmp(one.level(l).data(), many.level(l).data(), one.level(l).size_bytes()), 0);
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
