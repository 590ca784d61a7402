#include "render/normalisation/kernel_sums.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <glm/gtc/constants.hpp>
#include <numbers>
#include <numeric>
#include <random>

#include "render/lod/cut.h"
#include "render/lod/moment_tree.h"
#include "render/scene/builtin/procedural.h"
#include "render/scene/estimation/estimate.h"
#include "render/scene/io/open_scene.h"
#include "render/scene/mesh/sample_mesh.h"
#include "tests/cube_mesh.h"

namespace foci {
namespace FOCI_FILE {

/// Largest ripple of a grid's sum, for sigma over spacing. The kernel (1 - q)^2 of support sqrt(8)
/// sigma has the transform 48 J_3(k) / k^3, taken at the grid's first frequencies.
float rippleOf(double sigma) {
  double ripple = 0.0;
  for (const double frequency : {1.0, std::numbers::sqrt2, 2.0}) {
    const double k = 2.0 * std::numbers::pi * frequency * std::sqrt(8.0) * sigma;
    ripple += 4.0 * 48.0 * std::abs(std::cyl_bessel_j(3.0, k)) / (k * k * k);
  }
  return static_cast<float>(ripple) + 1e-3f;  // for all other frequencies
}

/// A scan's part with more than five thousand points.
const glm::vec3 kScansPart_m(-2.375f, 4.875f, -0.625f);
constexpr float kScansRadius_m = 0.45f;

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

/// The sum at a pixel of the side `pixel_m`: all kernels as rendered, without a tree or a reach.
double sumAt(const SurfelCloud& cloud, const glm::vec3& p, float pixel_m) {
  double sum = 0.0;
  for (std::size_t j = 0; j < cloud.size(); ++j) {
    const glm::vec3 d = p - cloud.position_m[j];
    const float v = glm::dot(cloud.axis_u_m[j], cloud.axis_u_m[j]) + pixel_m * pixel_m;
    const float left = 1.0f - glm::dot(d, d) / (8.0f * v);
    if (left > 0.0f) {
      sum += cloud.area_m2[j] * 3.0f / (8.0f * glm::pi<float>() * v) * left * left;
    }
  }
  return sum;
}

/// Share of points, `margin` within the border of a jittered plane, where a sum is off by more.
template <typename SumAt>
double shareOff(int side, float margin, double tolerance, const SumAt& sum) {
  std::mt19937 random(2);
  const auto inside = [&] {
    return margin + (static_cast<float>(side) - 2.0f * margin) * static_cast<float>(random() >> 8) *
                        0x1p-24f;
  };
  constexpr int kPlaces = 2000;
  int off = 0;
  for (int k = 0; k < kPlaces; ++k) {
    const float x = inside(), z = inside();
    off += std::abs(sum(glm::vec3(x, 0.0f, z)) - 1.0) > tolerance;
  }
  return static_cast<double>(off) / kPlaces;
}

TEST(SurfelsFromPoints, SumToOneWithinTwoPercentWhereThorough) {
  const int side = 90;
  for (const std::size_t at_once : {10'000, 2'500}) {
    std::size_t passes = 0, before = 0;
    const SurfelCloud cloud =
        surfelsFromPoints(jitteredPlane(side), {.solve = KernelSolve::thorough,
                                                .progress =
                                                    [&](std::size_t done, std::size_t total) {
                                                      EXPECT_EQ(done, ++before);
                                                      passes = done == total ? passes + 1 : passes;
                                                    },
                                                .solved_at_once = at_once});
    EXPECT_EQ(passes, 1u);
    const auto off = [&](float pixel_m, double tolerance) {
      return shareOff(side, 9.0f, tolerance,
                      [&](const glm::vec3& p) { return sumAt(cloud, p, pixel_m); });
    };
    EXPECT_LE(off(1.0f, 0.02), 0.01) << at_once;  // as on the paper's plane
    EXPECT_LE(off(0.5f, 0.05), 0.01) << at_once;  // seen from half as far
  }
}

TEST(SurfelsFromPoints, AreTheSameWhereSolvedInParts) {
  const auto solved = [](std::size_t at_once) {
    return surfelsFromPoints(jitteredPlane(90),
                             {.solve = KernelSolve::thorough, .solved_at_once = at_once});
  };
  const SurfelCloud whole = solved(10'000), parts = solved(2'500);
  ASSERT_EQ(parts.position_m, whole.position_m);
  for (std::size_t i = 0; i < whole.size(); ++i) {
    EXPECT_NEAR(parts.area_m2[i], whole.area_m2[i], 0.01f) << i;
    EXPECT_NEAR(glm::length(parts.axis_u_m[i]), glm::length(whole.axis_u_m[i]), 0.005f) << i;
  }
}

TEST(SurfelsFromPoints, ShowTheUnsolvedOnesWhereThorough) {
  const SurfelCloud none = surfelsFromPoints(jitteredPlane(20), {.solve = KernelSolve::none});
  std::vector<float> area_m2;
  surfelsFromPoints(jitteredPlane(20),
                    {.solve = KernelSolve::thorough, .unsolved = [&](const SurfelCloud& cloud) {
                       area_m2.assign(cloud.area_m2.begin(), cloud.area_m2.end());
                     }});
  EXPECT_EQ(area_m2, std::vector<float>(none.area_m2.begin(), none.area_m2.end()));
}

/// Seen from near, no prefilter evens the sums out. `foci prepare` once solved for a pixel of 0.63
/// spacings, which left 1 % of the sums of a magnified plane below 0.86.
TEST(SurfelsFromPoints, OfAMeshSumToOneHoweverMagnified) {
  TriangleMesh plane;
  addTriangle(plane, {0, 0, 0}, {120, 0, 120}, {120, 0, 0});
  addTriangle(plane, {0, 0, 0}, {0, 0, 120}, {120, 0, 120});
  const SurfelCloud cloud = surfelsFromPoints(sampleMesh(plane, "plane", {.points = 14'400}),
                                              {.solve = KernelSolve::thorough});
  EXPECT_GT(shareWithin(kernelSums(cloud, 20'000, {0.0f}), 0.1f, true), 0.995);
  EXPECT_GT(shareWithin(kernelSums(cloud, 20'000, {0.5f}), 0.05f, true), 0.999);
  EXPECT_GT(shareWithin(kernelSums(cloud, 20'000, {1.0f}), 0.02f, true), 0.999);
}

TEST(SurfelsFromPoints, SumsAreFarFromOneBeforeTheyAreSolved) {
  const SurfelCloud cloud = surfelsFromPoints(jitteredPlane(60), {.solve = KernelSolve::none});
  EXPECT_GT(shareOff(60, 9.0f, 0.02, [&](const glm::vec3& p) { return sumAt(cloud, p, 1.0f); }),
            0.5);
}

TEST(LevelKernels, SumToOneOverAJitteredPlaneAtEveryLevel) {
  const int side = 110;
  const MomentTree tree(surfelsFromPoints(jitteredPlane(side), {.solve = KernelSolve::thorough}));
  int levels = 0;
  for (int level = tree.levels() - 1; level > 0; --level) {
    const LevelKernels kernels = levelKernels(tree, level);
    const float spacing =
        static_cast<float>(side) / std::sqrt(static_cast<float>(kernels.surfels.size()));
    const float margin = 9.0f + 4.5f * spacing;  // beyond what a border can reach
    if (2.5f * margin > static_cast<float>(side)) break;
    ++levels;
    const auto off = [&](const SeenAs& seen, double tolerance) {
      return shareOff(side, margin, tolerance, [&](const glm::vec3& p) {
        return kernelSumAt(kernels.surfels, p, spacing, seen, kernels.added_m2);
      });
    };
    EXPECT_LE(off(kCoarsestSharp, 0.02), 0.01) << level;
    // A disc sampled by some forty nodes ripples by more, whatever their weights.
    EXPECT_LE(off(kCoarsestBlurred, 0.02), 0.05) << level;
    EXPECT_LE(off(kCoarsestBlurred, 0.04), 0.01) << level;
  }
  EXPECT_GE(levels, 4);
}

TEST(LevelKernels, SumToTheSurfelsAreaAtEveryLevel) {
  const SurfelCloud cloud = surfelsFromPoints(jitteredPlane(50));
  const double area = std::accumulate(cloud.area_m2.begin(), cloud.area_m2.end(), 0.0);
  const MomentTree tree(cloud);
  for (int level = 0; level < tree.levels(); ++level) {
    const MappedVector<float> of_nodes = levelKernels(tree, level).surfels.area_m2;
    EXPECT_NEAR(std::accumulate(of_nodes.begin(), of_nodes.end(), 0.0) / area, 1.0, 1e-3) << level;
  }
}

TEST(LevelKernels, SumToOneOnAScansSmoothPartsAtEveryLevel) {
  const char* folder = std::getenv("FOCI_DATA");
  const std::filesystem::path data = folder != nullptr ? folder : FOCI_SOURCE_DIR "/../shared/data";
  const std::filesystem::path scan = data / "scans/lion.ply";
  if (!std::filesystem::exists(scan)) GTEST_SKIP() << "no " << scan << " (set FOCI_DATA)";
  // A part of it, with leaves, holes and strays.
  PointCloud points = openPoints(readScene(scan), 1.0).points, some;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (glm::distance(points.position_m[i], kScansPart_m) > kScansRadius_m) continue;
    some.position_m.push_back(points.position_m[i]);
    some.normal.push_back(points.normal[i]);
    some.color.push_back(points.color[i]);
  }
  const SurfelCloud cloud = surfelsFromPoints(std::move(some), {.solve = KernelSolve::thorough});
  ASSERT_GT(cloud.size(), 5'000u);
  for (const float pixel : {1.0f, 0.5f}) {
    EXPECT_GT(shareWithin(kernelSums(cloud, 10'000, {pixel}), 0.1f, true), 0.95) << pixel;
  }
  const MomentTree tree(cloud);
  for (int level = tree.levels() - 1; level > tree.levels() - 3; --level) {
    const LevelKernels kernels = levelKernels(tree, level);
    for (const SeenAs& seen : {kCoarsestSharp, kCoarsestBlurred}) {
      const auto sums = kernelSums(kernels.surfels, 10'000, seen, kernels.added_m2);
      EXPECT_GT(std::count_if(sums.begin(), sums.end(), [](const auto& s) { return s.smooth; }), 50)
          << level;
      EXPECT_GT(shareWithin(sums, 0.1f, true), 0.95) << level;
    }
  }
}

TEST(SurfelsFromPoints, StayWithinTheirBoundsWhereThorough) {
  const SurfelCloud quick = surfelsFromPoints(jitteredPlane(20));
  const SurfelCloud thorough =
      surfelsFromPoints(jitteredPlane(20), {.solve = KernelSolve::thorough});
  ASSERT_EQ(quick.position_m, thorough.position_m);
  for (std::size_t i = 0; i < quick.size(); ++i) {
    const float grown = glm::length(thorough.axis_u_m[i]) / glm::length(quick.axis_u_m[i]);
    EXPECT_TRUE(grown > 0.62f && grown < 1.61f) << grown;
    EXPECT_GT(thorough.area_m2[i], 0.0f);
  }
}

TEST(KernelSums, AreOneOnARegularPlaneButForTheKernelsRipple) {
  for (const float pixel : {0.0f, 0.5f, 1.0f}) {
    const auto sums = kernelSums(makePlane(100, 3.0f), 4000, {pixel});
    EXPECT_EQ(sums.size(), 4000u);
    EXPECT_GT(std::count_if(sums.begin(), sums.end(), [](const auto& s) { return s.smooth; }),
              3100);
    EXPECT_GT(shareWithin(sums, rippleOf(std::hypot(kSigmaPerSpacing, pixel)), true), 0.97)
        << pixel;
  }
}

TEST(KernelSums, AreOneOnARegularPlaneHoweverBlurred) {
  for (const float blur : {2.0f, 5.0f, 8.0f}) {
    const auto sums = kernelSums(makePlane(100, 3.0f), 4000, {0.0f, blur});
    EXPECT_GT(shareWithin(sums, 0.03f, true), 0.97) << blur;
  }
}

TEST(KernelSums, SeeABorderAsFarAsKernelsReach) {
  // On a plane of n x n spacings the smooth part is the square within that reach.
  for (const float pixel : {0.5f, 1.0f, 2.0f}) {
    const auto sums = kernelSums(makePlane(100, 3.0f), 20'000, {pixel});
    const auto smooth = static_cast<double>(
        std::count_if(sums.begin(), sums.end(), [](const auto& s) { return s.smooth; }));
    const double reach = 2.4 * std::hypot(kSigmaPerSpacing, pixel);
    const double inside = 1.0 - 2.0 * reach / 100.0;
    EXPECT_NEAR(smooth / static_cast<double>(sums.size()), inside * inside, 0.03) << pixel;
  }
}

TEST(KernelSums, FollowTheWeights) {
  SurfelCloud plane = makePlane(100, 3.0f);
  for (float& area_m2 : plane.area_m2) area_m2 *= 1.5f;
  const auto sums = kernelSums(plane, 1000, {1.0f});
  EXPECT_EQ(shareWithin(sums, 0.1f, true), 0.0);
  EXPECT_GT(shareWithin(sums, 0.51f, true), 0.97);
}

TEST(KernelSums, AreTheSameSeenInOneWayOrInSeveral) {
  const SurfelCloud cloud = surfelsFromPoints(jitteredPlane(40), {.solve = KernelSolve::none});
  const SeenAs seen[] = {{1.0f}, {0.0f, 3.0f}, {0.0f}};
  const auto all = kernelSums(cloud, 1000, seen);
  ASSERT_EQ(all.size(), 3u);
  for (std::size_t s = 0; s < 3; ++s) {
    const auto alone = kernelSums(cloud, 1000, seen[s]);
    ASSERT_EQ(all[s].size(), alone.size());
    for (std::size_t k = 0; k < alone.size(); ++k) {
      EXPECT_NEAR(all[s][k].sum, alone[k].sum, 1e-5f);
      EXPECT_EQ(all[s][k].smooth, alone[k].smooth);
    }
  }
}

TEST(KernelSums, AgreeWithAllKernelsSummed) {
  SurfelCloud alone;
  appendSurfel(alone, {0.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}, 0.62f, 1.0f, glm::vec3(1.0f));
  const float variance = 0.62f * 0.62f;
  const float highest = 3.0f / (8.0f * glm::pi<float>() * variance);
  const float left = 1.0f - 0.5f / (8.0f * variance);
  const auto sums = kernelSums(alone, 100, {0.0f});
  for (const KernelSum& sum : sums) {  // up to half a spacing aside along both axes
    EXPECT_LE(sum.sum, highest * 1.0001f);
    EXPECT_GE(sum.sum, highest * left * left * 0.9999f);
    EXPECT_FALSE(sum.smooth);
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

}  // namespace FOCI_FILE
}  // namespace foci
