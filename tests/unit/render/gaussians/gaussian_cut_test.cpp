// Levels of detail of captured scenes: the tree, the cut, and what both leave of the image.
#include "render/gaussians/gaussian_cut.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "render/image/metrics.h"
#include "render/image/srgb.h"
#include "render/methods/method.h"
#include "render/scene/gaussian_merge.h"
#include "render/scene/tree_order.h"
#include "tests/unit/render/gaussian_scenes.h"
#include "tests/unit/render/method_scenes.h"

namespace foci {
namespace FOCI_FILE {

/// Small Gaussians in a ball 2 m before the eye.
GaussianCloud ball(int n, float sigma_m = 0.01f, float opacity = 1.0f) {
  std::mt19937 random(3);
  const auto uniform = [&](float a, float b) {
    return a + (b - a) * static_cast<float>(random() >> 8) / static_cast<float>(1 << 24);
  };
  GaussianCloud cloud;
  while (cloud.size() < static_cast<std::size_t>(n)) {
    const glm::vec3 p(uniform(-1.0f, 1.0f), uniform(-1.0f, 1.0f), uniform(-1.0f, 1.0f));
    if (glm::length(p) > 1.0f) continue;
    addGaussian(cloud, 0.5f * p - glm::vec3(0.0f, 0.0f, 2.0f),
                sigma_m * glm::vec3(uniform(0.5f, 1.0f), uniform(0.5f, 1.0f), 0.3f),
                opacity * uniform(0.3f, 1.0f),
                {uniform(0.2f, 0.9f), uniform(0.2f, 0.9f), uniform(0.2f, 0.9f)},
                glm::normalize(glm::vec4(uniform(-1.0f, 1.0f), uniform(-1.0f, 1.0f),
                                         uniform(-1.0f, 1.0f), uniform(-1.0f, 1.0f))));
  }
  return cloud;
}

const View kView = squareView(128, 200.0f);

/// How often the cut holds each Gaussian.
std::vector<int> timesInCut(const GaussianCloud& cloud, const GaussianCut& cut) {
  std::vector<int> times(cloud.size());
  for (const std::uint32_t i : cut.gaussians) ++times[i];
  for (const std::uint32_t node : cut.nodes) {
    int level = 0;
    while (node >> (level + 1) != 0) ++level;
    const auto [begin, end] = rangeBelow(cloud.size(), level, node - (std::size_t{1} << level));
    for (std::size_t i = begin; i < end; ++i) ++times[i];
  }
  return times;
}

TEST(GaussianCut, HoldsEachGaussianOnce) {
  const GaussianCloud cloud = withTree(ball(3000));
  for (const float radius_px_per_D : {0.0f, 30.0f, 1000.0f}) {
    const RenderSettings settings = lens(radius_px_per_D, 3.0f);
    GaussianCut cut;
    selectCut(cloud, kView, settings.defocus, {.per_blur2 = 0.1f}, cut);
    EXPECT_EQ(std::ranges::count(timesInCut(cloud, cut), 1), 3000) << radius_px_per_D;
    if (radius_px_per_D > 100.0f) {
      EXPECT_LT(cut.size(), 10u);
    }
  }
}

TEST(GaussianCut, ShrinksWithTheSquareOfTheBlur) {
  // All of it is far from focus. Nodes are as wide as the blur, in three dimensions.
  const GaussianCloud cloud = withTree(ball(20'000));
  GaussianCut some, few;
  selectCut(cloud, kView, lens(10.0f, 3.0f).defocus, {.per_blur2 = 0.02f}, some);
  selectCut(cloud, kView, lens(40.0f, 3.0f).defocus, {.per_blur2 = 0.02f}, few);
  EXPECT_LT(some.size(), 20'000u / 2);
  EXPECT_LT(few.size(), some.size() / 8);
}

TEST(GaussianCut, NodesHoldTheirGaussians) {
  const GaussianCloud cloud = withTree(ball(2000));
  const GaussianTree& tree = *cloud.tree;
  for (std::size_t node = 1; node < tree.radius_m.size(); ++node) {
    int level = 0;
    while (node >> (level + 1) != 0) ++level;
    const auto [begin, end] = rangeBelow(cloud.size(), level, node - (std::size_t{1} << level));
    for (std::size_t i = begin; i < end; ++i) {
      const Covariance3& v = cloud.covariance_m2[i];
      const float reach = 3.0f * std::sqrt(std::max({v.xx, v.yy, v.zz}));
      ASSERT_LE(glm::distance(tree.nodes.position_m[node], cloud.position_m[i]) + reach,
                tree.radius_m[node]);
    }
  }
}

TEST(GaussianCut, ALargeGaussianDoesNotJoinSmallOnes) {
  GaussianCloud cloud = ball(1000, 0.002f);
  addGaussian(cloud, {0.0f, 0.0f, -2.0f}, glm::vec3(0.5f), 0.5f, glm::vec3(0.5f));
  cloud = withTree(cloud);
  // One cluster, and its ancestors, spread by more than a tenth of its size.
  const GaussianTree& tree = *cloud.tree;
  int wide = 0;
  for (std::size_t node = std::size_t{1} << (tree.levels - 1); node < tree.radius_m.size();
       ++node) {
    wide += tree.radius_m[node] > 1.0f;
  }
  EXPECT_EQ(wide, 1);
}

TEST(GaussianCut, WithoutMergingTheImageIsThatOfAllGaussians) {
  const GaussianCloud scene = ball(3000);
  const Frame all = render("pinhole", scene, kView, {});
  const Frame cut = render("sweep-lod:7", scene, kView, {});
  EXPECT_GT(psnr_dB(cut, all), 60.0);
}

TEST(GaussianCut, BlurredFogAndSolidsKeepTheirLight) {
  // Opaque Gaussians hide each other, faint ones add up. Between them lies what is hidden by
  // chance.
  struct Ball {
    float opacity;
    double least_dB;
  };
  constexpr double kShare = 0.07;
  for (const auto& [opacity, least_dB] : {Ball{1.0f, 38.0}, Ball{0.1f, 50.0}, Ball{0.02f, 73.0}}) {
    const GaussianCloud scene = ball(20'000, 0.01f, opacity);
    const RenderSettings settings = lens(60.0f, 1.5f);  // 30 px at its front to 48 px at its back
    const Frame points = render("accumulate:64", scene, kView, settings);
    const Frame merged = render("sweep-lod:19", scene, kView, settings);
    const double light = meanLuminance(points);
    EXPECT_NEAR(meanLuminance(merged), light, kShare * light) << opacity;
    EXPECT_GT(psnr_dB(merged, points), least_dB) << opacity;
  }
}

struct Crowd {
  float sigma_px, opacity;
};
class CrowdOfGaussians : public testing::TestWithParam<Crowd> {};

TEST_P(CrowdOfGaussians, OfTwoColoursKeepsItsLight) {
  // Dark and light ones at random, about as many to a pixel as captures have. Opaque, they hide
  // each other; faint, they blend; small, the low-pass of the rasteriser makes them fill pixels.
  constexpr int kCount = 100'000;
  GaussianCloud cloud = ball(kCount);
  constexpr float kPixel_m = 0.01f;  // in the middle of the ball
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const float variance_m2 = std::pow(GetParam().sigma_px * kPixel_m, 2.0f);
    cloud.covariance_m2[i] = {.xx = variance_m2, .yy = variance_m2, .zz = variance_m2};
    cloud.opacity[i] = GetParam().opacity;
    cloud.color[i] = glm::vec3(i % 2 == 0 ? 0.1f : 0.9f);
  }
  const GaussianCloud& scene = cloud;
  const RenderSettings settings = lens(60.0f, 1.5f);
  const Frame all = render("sweep:19", scene, kView, settings);
  const Frame merged = render("sweep-lod:19", scene, kView, settings);
  const double light = meanLuminance(all);
  constexpr double kShare = 0.08, kLeast_dB = 37.0;
  EXPECT_NEAR(meanLuminance(merged), light, kShare * light);
  EXPECT_GT(psnr_dB(merged, all), kLeast_dB);
}

INSTANTIATE_TEST_SUITE_P(GaussianCut, CrowdOfGaussians,
                         testing::Values(Crowd{0.05f, 0.3f}, Crowd{0.2f, 1.0f}, Crowd{1.0f, 0.3f},
                                         Crowd{3.0f, 0.05f}));

TEST(GaussianCut, FoveationMergesGaussiansBesideTheGaze) {
  const GaussianCloud scene = ball(20'000);
  const View view = squareView(256, 200.0f);
  RenderSettings settings;
  const auto method = makeMethod("auto", scene);
  Frame all, foveated;
  const std::uint64_t of_all = method->render(view, settings, all).splats;
  // The ball is 100 px wide. At 100 px from the gaze the acuity's deviation is 11 px.
  settings.quality.acuity = {.gaze_px = {80.0f, 128.0f}, .base_px = 1.0f, .per_px = 0.1f};
  EXPECT_LT(method->render(view, settings, foveated).splats, of_all * 3 / 4);
  double near = 0.0, far = 0.0;
  for (int y = 100; y < 156; ++y) {
    for (int x = 0; x < 8; ++x) {
      near = std::max(near, double{std::abs(all.at(78 + x, y).g - foveated.at(78 + x, y).g)});
      far = std::max(far, double{std::abs(all.at(168 + x, y).g - foveated.at(168 + x, y).g)});
    }
  }
  EXPECT_LT(near, 0.05);
  EXPECT_GT(far, 2.0 * near);
}

TEST(GaussianCut, TheUsualMethodsRenderFewerWhereBlurred) {
  const GaussianCloud scene = ball(20'000);
  const View view = squareView(48, 40.0f);
  for (const char* method : {"sweep-lod", "sweep-lod:1", "auto", "auto:5"}) {
    Frame frame;
    const auto renderer = makeMethod(method, scene);
    const std::uint64_t sharp = renderer->render(view, lens(0.0f, 1.5f), frame).splats;
    const std::uint64_t blurred = renderer->render(view, lens(30.0f, 1.5f), frame).splats;
    EXPECT_GT(sharp, 15'000u) << method;
    EXPECT_LT(blurred, sharp / 4) << method;
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
