#include "render/scene/estimation/estimate.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/gtc/constants.hpp>
#include <limits>
#include <map>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

namespace foci {
namespace FOCI_FILE {

constexpr float kNormalAngle_rad = 0.03f;  // 16 neighbours on a sphere of 20,000 points: curvature
constexpr double kArea = 0.03;             // statistical: density from 16 neighbours, averaged

float uniform(std::mt19937& random) { return static_cast<float>(random() >> 8) * 0x1p-24f; }

PointCloud coloured(std::vector<glm::vec3> positions) {
  PointCloud points;
  points.color.assign(positions.size(), glm::vec3(0.5f));
  points.position_m = std::move(positions);
  return points;
}

/// Points of a unit sphere by Fibonacci's spiral, each moved by up to `jitter` of the spacing.
std::vector<glm::vec3> sphere(int count, float jitter) {
  std::mt19937 random(1);
  std::vector<glm::vec3> points;
  const float spacing = std::sqrt(4.0f * glm::pi<float>() / static_cast<float>(count));
  for (int i = 0; i < count; ++i) {
    const float y = 1.0f - (2.0f * static_cast<float>(i) + 1.0f) / static_cast<float>(count);
    const float a = 2.399963f * static_cast<float>(i), r = std::sqrt(1.0f - y * y);
    const glm::vec3 move(uniform(random) - 0.5f, uniform(random) - 0.5f, uniform(random) - 0.5f);
    points.push_back(
        glm::normalize(glm::vec3(r * std::cos(a), y, r * std::sin(a)) + jitter * spacing * move));
  }
  return points;
}

/// side x side points of a unit-spaced grid in y = 0, each moved by up to half of `jitter`.
std::vector<glm::vec3> plane(int side, float jitter) {
  std::mt19937 random(2);
  std::vector<glm::vec3> points;
  for (int i = 0; i < side * side; ++i) {
    const float z = static_cast<float>(i / side) + jitter * (uniform(random) - 0.5f);
    const float x = static_cast<float>(i % side) + jitter * (uniform(random) - 0.5f);
    points.emplace_back(x, 0.0f, z);
  }
  return points;
}

glm::vec3 normalOf(const SurfelCloud& cloud, std::size_t i) {
  return glm::normalize(glm::cross(cloud.axis_u_m[i], cloud.axis_v_m[i]));
}

double kernelSum(const SurfelCloud& cloud, const glm::vec3& p) {
  double sum = 0.0;
  for (std::size_t j = 0; j < cloud.size(); ++j) {
    const glm::vec3 d = p - cloud.position_m[j];
    const float s2 = glm::dot(cloud.axis_u_m[j], cloud.axis_u_m[j]);
    const float distance2 = glm::dot(d, d);
    if (distance2 < 36.0f * s2) {
      sum += cloud.area_m2[j] / (glm::two_pi<float>() * s2) * std::exp(-0.5f * distance2 / s2);
    }
  }
  return sum;
}

/// The surfel at a place: surfels come in an order of their own.
std::size_t at(const SurfelCloud& cloud, const glm::vec3& p) {
  const auto found = std::find(cloud.position_m.begin(), cloud.position_m.end(), p);
  EXPECT_NE(found, cloud.position_m.end());
  return static_cast<std::size_t>(found - cloud.position_m.begin());
}

void expectSound(const SurfelCloud& cloud, std::size_t size) {
  ASSERT_EQ(cloud.size(), size);
  ASSERT_EQ(cloud.axis_u_m.size(), size);
  ASSERT_EQ(cloud.area_m2.size(), size);
  for (std::size_t i = 0; i < size; ++i) {
    const float u = glm::length(cloud.axis_u_m[i]), v = glm::length(cloud.axis_v_m[i]);
    ASSERT_TRUE(std::isfinite(u) && u > 0.0f) << i;
    ASSERT_TRUE(std::isfinite(v) && v > 0.0f) << i;
    ASSERT_LT(std::abs(glm::dot(cloud.axis_u_m[i], cloud.axis_v_m[i])), 1e-5f * u * v) << i;
    ASSERT_TRUE(std::isfinite(cloud.area_m2[i]) && cloud.area_m2[i] > 0.0f) << i;
  }
}

TEST(SurfelsFromPoints, FindTheNormalsOfASphere) {
  const SurfelCloud cloud = surfelsFromPoints(coloured(sphere(20000, 0.5f)));
  expectSound(cloud, 20000);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    EXPECT_GT(glm::dot(normalOf(cloud, i), cloud.position_m[i]), std::cos(kNormalAngle_rad)) << i;
  }
}

TEST(SurfelsFromPoints, TurnNormalsTowardsTheViewpoint) {
  const SurfelCloud cloud =
      surfelsFromPoints(coloured(plane(10, 0.3f)), {.viewpoint_m = glm::vec3(3.0f, -9.0f, 2.0f)});
  for (std::size_t i = 0; i < cloud.size(); ++i) EXPECT_LT(normalOf(cloud, i).y, -0.999f);
}

TEST(SurfelsFromPoints, HaveTheAreaOfASphere) {
  for (const float jitter : {0.0f, 0.8f}) {
    const SurfelCloud cloud = surfelsFromPoints(coloured(sphere(20000, jitter)));
    const double area = std::accumulate(cloud.area_m2.begin(), cloud.area_m2.end(), 0.0);
    EXPECT_NEAR(area / (4.0 * glm::pi<double>()), 1.0, kArea) << "jitter " << jitter;
  }
}

TEST(SurfelsFromPoints, HaveKernelsThatSumToOne) {
  struct Case {
    float jitter;
    double mean, deviation;  // of the sum from 1, over the plane; the paper reaches 0.1
  };
  for (const Case& c : {Case{0.0f, 0.01, 0.01}, Case{0.5f, 0.02, 0.06}, Case{1.0f, 0.03, 0.10}}) {
    const SurfelCloud cloud = surfelsFromPoints(coloured(plane(40, c.jitter)));
    std::mt19937 random(3);
    double sum = 0.0, squares = 0.0;
    const int probes = 1000;
    for (int i = 0; i < probes; ++i) {
      const double at =
          kernelSum(cloud, {5.0f + 29.0f * uniform(random), 0.0f, 5.0f + 29.0f * uniform(random)});
      sum += at - 1.0;
      squares += (at - 1.0) * (at - 1.0);
    }
    EXPECT_NEAR(sum / probes, 0.0, c.mean) << "jitter " << c.jitter;
    EXPECT_LT(std::sqrt(squares / probes), c.deviation) << "jitter " << c.jitter;
  }
}

/// The surface of an open mesh goes on under a body that stands on it: neither the body's
/// downward face nor its denser sampling takes area from the ground around it.
TEST(SurfelsFromPoints, OfTheGroundHaveTheSameAreaUnderABody) {
  const EstimateSettings ways[] = {
      {.solve = KernelSolve::quick},
      {.solve = KernelSolve::thorough},
      {.solve = KernelSolve::thorough, .solved_at_once = 400},  // parts of it see the body alone
  };
  for (const EstimateSettings& settings : ways) {
    for (const float spacing_m : {1.0f, 0.25f}) {
      PointCloud ground = coloured(plane(40, 0.8f));
      const std::size_t of_ground = ground.size();
      ground.normal.assign(of_ground, glm::vec3(0.0f, 1.0f, 0.0f));
      ground.area_m2.assign(of_ground, 1.0f);
      ground.body.assign(of_ground, 0);
      PointCloud both = ground;
      for (const glm::vec3& p : plane(static_cast<int>(10.0f / spacing_m), 0.8f)) {
        both.position_m.push_back(glm::vec3(15.0f, 0.0f, 15.0f) + spacing_m * p);
        both.normal.emplace_back(0.0f, -1.0f, 0.0f);
        both.color.emplace_back(0.5f);
        both.area_m2.push_back(spacing_m * spacing_m);
        both.body.push_back(1);
      }
      const SurfelCloud alone = surfelsFromPoints(std::move(ground), settings);
      const SurfelCloud beside = surfelsFromPoints(std::move(both), settings);
      std::map<std::pair<float, float>, float> area_m2;
      for (std::size_t i = 0; i < alone.size(); ++i) {
        area_m2[{alone.position_m[i].x, alone.position_m[i].z}] = alone.area_m2[i];
      }
      double worst = 0.0;
      std::size_t found = 0;
      for (std::size_t i = 0; i < beside.size(); ++i) {
        const auto same = area_m2.find({beside.position_m[i].x, beside.position_m[i].z});
        if (same == area_m2.end()) continue;
        ++found;
        worst = std::max(worst, std::abs(std::log(double{beside.area_m2[i] / same->second})));
      }
      EXPECT_EQ(found, of_ground);
      EXPECT_LT(worst, 1e-3) << spacing_m;
    }
  }
}

TEST(SurfelsFromPoints, TakeRadiusAndNormalWhereGiven) {
  PointCloud points = coloured(plane(20, 0.0f));
  points.normal.assign(points.size(), glm::vec3(0.0f, 1.0f, 0.0f));
  points.normal[210] = glm::vec3(0.0f);
  points.radius_m.assign(points.size(), std::sqrt(0.5f));
  points.radius_m[211] = 0.0f;
  const SurfelCloud cloud = surfelsFromPoints(std::move(points));
  expectSound(cloud, 400);
  const auto sigma = [&](const glm::vec3& p) { return glm::length(cloud.axis_u_m[at(cloud, p)]); };
  EXPECT_NEAR(std::abs(normalOf(cloud, at(cloud, {10.0f, 0.0f, 10.0f})).y), 1.0f, 1e-5f);
  EXPECT_FLOAT_EQ(sigma({12.0f, 0.0f, 10.0f}), kSigmaPerSpacing);
  EXPECT_NEAR(sigma({11.0f, 0.0f, 10.0f}), kSigmaPerSpacing, 0.02f);
}

TEST(SurfelsFromPoints, KeepStraysSmall) {
  std::vector<glm::vec3> positions = plane(20, 0.2f);
  positions.emplace_back(10.0f, 500.0f, 10.0f);
  positions.emplace_back(10.0f, 8.0f, 10.0f);
  const SurfelCloud cloud = surfelsFromPoints(coloured(positions));
  expectSound(cloud, positions.size());
  for (const glm::vec3& stray : {positions[400], positions[401]}) {
    EXPECT_LT(glm::length(cloud.axis_u_m[at(cloud, stray)]), 3.0f);
  }
}

TEST(SurfelsFromPoints, AreSoundForDegenerateClouds) {
  const auto check = [](const std::vector<glm::vec3>& positions) {
    expectSound(surfelsFromPoints(coloured(positions)), positions.size());
  };
  EXPECT_TRUE(surfelsFromPoints({}).empty());
  check({{1.0f, 2.0f, 3.0f}});
  check({{0.0f, 0.0f, 0.0f}, {1.0f, 0.0f, 0.0f}});
  check({{0.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 0.0f}});
  check(std::vector<glm::vec3>(50000, {1.0f, 1.0f, 1.0f}));  // must not take quadratic time
  check({{-1e9f, 1e9f, 1e9f}, {1e9f, -1e9f, 1e9f}, {0.0f, 0.0f, 0.0f}});
  check({{0.0f, 0.0f, 0.0f}, {1e-40f, 0.0f, 0.0f}, {0.0f, 1e-38f, 0.0f}});
  std::vector<glm::vec3> line, exponential, pairs;
  for (int i = 0; i < 200; ++i) line.emplace_back(0.1f * static_cast<float>(i), 0.0f, 0.0f);
  for (int i = -100; i < 29; ++i) exponential.emplace_back(std::ldexp(1.0f, i), 0.0f, 1.0f);
  for (int i = 0; i < 400; ++i) pairs.emplace_back(static_cast<float>(i / 40), 0.0f, 0.0f);
  check(line);
  check(exponential);
  check(pairs);
}

TEST(SurfelsFromPoints, ShareTheAreaOfCoincidentPoints) {
  const std::vector<glm::vec3> once = plane(20, 0.0f);
  std::vector<glm::vec3> often;
  for (int i = 0; i < 40; ++i) often.insert(often.end(), once.begin(), once.end());
  const SurfelCloud single = surfelsFromPoints(coloured(once));
  const SurfelCloud stacked = surfelsFromPoints(coloured(often));
  expectSound(stacked, often.size());
  const std::size_t one = at(single, once[210]), many = at(stacked, once[210]);
  EXPECT_FLOAT_EQ(stacked.area_m2[many], single.area_m2[one] / 40.0f);
  EXPECT_EQ(stacked.axis_u_m[many], single.axis_u_m[one]);
}

TEST(SurfelsFromPoints, KeepEachPointsOwnColourAndLieNearInMemoryWhereNearInSpace) {
  PointCloud points = coloured(sphere(20000, 0.5f));
  for (std::size_t i = 0; i < points.size(); ++i) points.color[i] = glm::abs(points.position_m[i]);
  const SurfelCloud cloud = surfelsFromPoints(std::move(points));
  double step = 0.0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    ASSERT_EQ(cloud.color[i], glm::abs(cloud.position_m[i])) << i;
    if (i > 0) step += glm::distance(cloud.position_m[i], cloud.position_m[i - 1]);
  }
  EXPECT_LT(step / 20000.0, 0.05);  // two spacings; in the spiral's order it would be 0.9
}

TEST(SurfelsFromPoints, AreTheSameAtAnyNumberOfThreads) {
  const auto make = [](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return surfelsFromPoints(coloured(sphere(20000, 0.7f)));
  };
  const SurfelCloud one = make(1), four = make(4);
  EXPECT_EQ(one.axis_u_m, four.axis_u_m);
  EXPECT_EQ(one.area_m2, four.area_m2);
}

}  // namespace FOCI_FILE
}  // namespace foci
