#include "render/scene/kernel_sums.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <random>

#include "render/scene/estimate.h"
#include "render/scene/procedural.h"

namespace foci {
namespace {

constexpr float kRipple = 0.006f;  // of a regular grid of sigma 0.62: 4 exp(-2 pi^2 0.62^2)

/// side x side points of a grid in y = 0, one a square metre, each anywhere in its square.
PointCloud jitteredPlane(int side) {
  std::mt19937 random(1);
  const auto uniform = [&] { return static_cast<float>(random() >> 8) * 0x1p-24f; };
  PointCloud points;
  for (int i = 0; i < side * side; ++i) {
    const float x = static_cast<float>(i % side) + uniform();
    points.position_m.emplace_back(x, 0.0f, static_cast<float>(i / side) + uniform());
  }
  points.color.assign(points.size(), glm::vec3(0.5f));
  return points;
}

/// As a pixel sees it, of the side `pixel_m`: all kernels, without a tree or a reach.
double sumAt(const SurfelCloud& cloud, const glm::vec3& p, float pixel_m) {
  double sum = 0.0;
  for (std::size_t j = 0; j < cloud.size(); ++j) {
    const glm::vec3 d = p - cloud.position_m[j];
    const float v = glm::dot(cloud.axis_u_m[j], cloud.axis_u_m[j]) + pixel_m * pixel_m;
    const float q = 0.5f * glm::dot(d, d) / v;
    if (q < 20.0f) sum += cloud.area_m2[j] / (glm::two_pi<float>() * v) * std::exp(-q);
  }
  return sum;
}

TEST(SurfelsFromPoints, SumToOneWithinTwoPercentWhereThorough) {
  const int side = 40;
  std::size_t passes = 0;
  const SurfelCloud cloud = surfelsFromPoints(
      jitteredPlane(side), {.thorough = true, .progress = [&](std::size_t done, std::size_t total) {
                              EXPECT_LE(done, total);
                              passes = done == total ? passes + 1 : passes;
                            }});
  EXPECT_EQ(passes, 1u);
  std::mt19937 random(2);
  const auto inside = [&] {  // beyond what a border can reach
    return 6.0f + static_cast<float>(side - 12) * static_cast<float>(random() >> 8) * 0x1p-24f;
  };
  const int probes = 1000;
  int outside = 0;
  for (int k = 0; k < probes; ++k) {
    const glm::vec3 p(inside(), 0.0f, inside());
    // Pixels as wide as half a spacing, a harder case than the paper's.
    outside += std::abs(sumAt(cloud, p, 0.5f) - 1.0) > 0.02;
  }
  EXPECT_LE(outside, probes / 100);
}

TEST(SurfelsFromPoints, StayWithinTheirBoundsWhereThorough) {
  const SurfelCloud quick = surfelsFromPoints(jitteredPlane(20));
  const SurfelCloud thorough = surfelsFromPoints(jitteredPlane(20), {.thorough = true});
  ASSERT_EQ(quick.position_m, thorough.position_m);
  for (std::size_t i = 0; i < quick.size(); ++i) {
    const float grown = glm::length(thorough.axis_u_m[i]) / glm::length(quick.axis_u_m[i]);
    EXPECT_TRUE(grown > 0.62f && grown < 1.61f) << grown;
    EXPECT_GT(thorough.area_m2[i], 0.0f);
  }
}

TEST(KernelSums, AreOneOnARegularPlane) {
  for (const float pixel : {0.0f, 0.5f, 1.0f}) {
    const auto sums = kernelSums(makePlane(100, 3.0f), 4000, {pixel});
    EXPECT_EQ(sums.size(), 4000u);
    EXPECT_GT(std::count_if(sums.begin(), sums.end(), [](const auto& s) { return s.smooth; }),
              3500);
    // A border is felt further off than it is looked for.
    EXPECT_GT(shareWithin(sums, kRipple, true), 0.88);
  }
}

TEST(KernelSums, FollowTheWeights) {
  SurfelCloud plane = makePlane(100, 3.0f);
  for (float& area_m2 : plane.area_m2) area_m2 *= 1.5f;
  const auto sums = kernelSums(plane, 1000, {0.0f});
  EXPECT_EQ(shareWithin(sums, 0.1f, true), 0.0);
  EXPECT_GT(shareWithin(sums, 0.51f, true), 0.97);
}

TEST(KernelSums, AgreeWithAllKernelsSummed) {
  SurfelCloud alone;
  appendSurfel(alone, {0.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}, 0.62f, 1.0f, glm::vec3(1.0f));
  const float highest = 1.0f / (glm::two_pi<float>() * 0.62f * 0.62f);
  const auto sums = kernelSums(alone, 100, {0.0f});
  for (const KernelSum& sum : sums) {  // up to half a spacing aside along both axes
    EXPECT_LE(sum.sum, highest * 1.0001f);
    EXPECT_GE(sum.sum, highest * std::exp(-0.5f * 0.5f / (0.62f * 0.62f)) * 0.9999f);
  }
}

TEST(KernelSums, DoNotMixSheets) {
  SurfelCloud plane = makePlane(60, 3.0f);
  const SurfelCloud below = makePlane(60, 3.0f);
  for (std::size_t i = 0; i < below.size(); ++i) {
    appendSurfel(plane, below.position_m[i] - glm::vec3(0.0f, 0.15f, 0.0f), {0.0f, 1.0f, 0.0f},
                 kSigmaPerSpacing * 0.05f, below.area_m2[i], glm::vec3(1.0f));
  }
  const auto sums = kernelSums(plane, 1000, {0.5f});
  EXPECT_GT(shareWithin(sums, 0.02f, false), 0.8);  // but for the border
}

TEST(KernelSums, GiveUpWhereAllSurfelsCoincide) {
  SurfelCloud point;
  for (int i = 0; i < 5000; ++i) {
    appendSurfel(point, glm::vec3(1.0f), {0.0f, 1.0f, 0.0f}, 0.1f, 0.01f, glm::vec3(1.0f));
  }
  EXPECT_TRUE(kernelSums(point, 100, {1.0f}).empty());
  EXPECT_EQ(shareWithin({}, 0.1f, true), 1.0);
}

}  // namespace
}  // namespace foci
