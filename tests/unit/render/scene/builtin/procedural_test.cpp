#include "render/scene/builtin/procedural.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "render/lod/surface_query.h"
#include "render/normalisation/kernel_sums.h"
#include "render/optics/view.h"
#include "render/scene/gaussian_cloud.h"
#include "render/scene/sampling/implicit_surface.h"
#include "render/scene/sampling/sample_surface.h"

namespace foci {
namespace FOCI_FILE {

TEST(MakePlane, HasThePapersSurfelsAndItsArea) {
  const SurfelCloud plane = makePlane();
  EXPECT_EQ(plane.size(), 262144u);
  const double area = std::accumulate(plane.area_m2.begin(), plane.area_m2.end(), 0.0);
  EXPECT_NEAR(area, 4.0, 1e-4);  // float sums
}

TEST(MakeFence, HidesSomeOfAWallThatFillsTheViewBehindIt) {
  const SurfelCloud fence = makeFence();
  double near_m2 = 0.0, far_m2 = 0.0;
  for (std::size_t i = 0; i < fence.size(); ++i) {
    const bool is_near = fence.position_m[i].z == -0.5f;
    EXPECT_TRUE(is_near || std::abs(fence.position_m[i].z + 1.5f) < 1e-6f);
    const glm::vec3 normal = glm::cross(fence.axis_u_m[i], fence.axis_v_m[i]);
    EXPECT_NEAR(normal.z, glm::length(normal), 1e-3f * glm::length(normal));  // towards the eye
    (is_near ? near_m2 : far_m2) += fence.area_m2[i];
  }
  EXPECT_NEAR(far_m2, 1.44, 1e-4);  // float sums
  // 12 wires of 0.5, 1, 2 and 4 mm, 0.4 m long and a little more where they lean, and a slat.
  EXPECT_NEAR(near_m2, 0.4 * (3 * 0.0075 + 0.003), 1e-4);
}

TEST(MakeGarden, IsASoundSceneOfGaussiansAtSeveralDepths) {
  const GaussianCloud g = makeGarden();
  EXPECT_LT(g.size(), 200'000u);  // small enough to chart
  EXPECT_EQ(g.harmonics.size(), g.size() * g.harmonicsPerGaussian());
  std::size_t veil = 0, thin = 0;
  for (std::size_t i = 0; i < g.size(); ++i) {
    const Covariance3& v = g.covariance_m2[i];
    const float trace = v.xx + v.yy + v.zz;
    ASSERT_TRUE(std::isfinite(trace) && v.xx > 0.0f && v.yy > 0.0f && v.zz > 0.0f) << i;
    ASSERT_TRUE(g.opacity[i] > 0.0f && g.opacity[i] < 1.0f) << i;
    veil += g.opacity[i] < 0.1f;
    thin += g.position_m[i].z > -1.2f && g.opacity[i] == 0.9f;
  }
  EXPECT_GT(veil, 100u);
  EXPECT_GT(thin, 1000u);
}

class GalleryTest : public testing::Test {
 protected:
  static void SetUpTestSuite() { gallery_ = new SurfelCloud(makeGallery()); }
  static void TearDownTestSuite() { delete gallery_; }
  static SurfelCloud* gallery_;
};
SurfelCloud* GalleryTest::gallery_ = nullptr;

TEST_F(GalleryTest, IsSoundAndSmallEnoughToReplay) {
  const SurfelCloud& g = *gallery_;
  EXPECT_GT(g.size(), 300000u);
  EXPECT_LT(g.size(), 600000u);
  for (std::size_t i = 0; i < g.size(); ++i) {
    const float u = glm::length(g.axis_u_m[i]), v = glm::length(g.axis_v_m[i]);
    ASSERT_TRUE(std::isfinite(u * v) && u > 0.0f && v > 0.0f) << i;
    ASSERT_LT(std::abs(glm::dot(g.axis_u_m[i], g.axis_v_m[i])), 2e-3f * u * v) << i;
    ASSERT_GT(g.area_m2[i], 0.0f);
    for (int c = 0; c < 3; ++c) ASSERT_TRUE(g.color[i][c] >= 0.0f && g.color[i][c] <= 1.0f) << i;
  }
}

TEST_F(GalleryTest, ShowsItsPlacesOfInterestWhereItSaysFromNearToFar) {
  const EyePose pose = galleryEyePose();
  const SurfaceQuery query(*gallery_);
  double previous_m = 0.0;
  for (const PointOfInterest& point : galleryPointsOfInterest()) {
    const glm::dvec3 sight = glm::dvec3(point.p_world) - glm::dvec3(pose.position_m);
    const double distance_m = glm::length(sight);
    const auto seen_m = query.distance(pose.position_m, sight / distance_m, glm::radians(0.5), 0.5);
    ASSERT_TRUE(seen_m) << point.name;
    EXPECT_NEAR(1.0 / *seen_m, 1.0 / distance_m, 0.05)
        << point.name;  // dioptres: half a depth of focus
    EXPECT_GT(distance_m, previous_m) << point.name;
    previous_m = distance_m;
  }
}

TEST_F(GalleryTest, ReachesFromAQuarterMetreToSix) {
  const EyePose pose = galleryEyePose();
  const SurfaceQuery query(*gallery_);
  const View view = viewThroughScreen(eyeFromWorld(pose.position_m, pose.target_m, pose.up),
                                      {1280, 720}, {0.5, 0.28125}, 0.6);
  const glm::dmat3 world_from_eye(glm::transpose(glm::mat3(view.eye_from_world)));
  double nearest_m = 99.0, furthest_m = 0.0;
  for (int y = 20; y < 720; y += 40) {
    for (int x = 20; x < 1280; x += 40) {
      const glm::dvec3 direction = world_from_eye * directionThrough(view, glm::dvec2(x, y));
      const auto seen_m = query.distance(pose.position_m, direction, glm::radians(0.5), 0.5);
      ASSERT_TRUE(seen_m) << "a hole at " << x << ", " << y;
      nearest_m = std::min(nearest_m, *seen_m);
      furthest_m = std::max(furthest_m, *seen_m);
    }
  }
  EXPECT_NEAR(nearest_m, 0.27, 0.04);
  EXPECT_NEAR(furthest_m, 6.2, 0.4);
}

TEST(MakeStatue, IsAClosedSolidOfThePapersNumberOfSurfels) {
  const SurfelCloud statue = makeStatue();
  ASSERT_EQ(statue.size(), kStatueSurfels);
  EXPECT_TRUE(statue.oriented);
  double area_m2 = 0.0, volume_m3 = 0.0;
  glm::dvec3 sum_m2(0.0);
  for (std::size_t i = 0; i < statue.size(); ++i) {
    const glm::dvec3 normal =
        glm::normalize(glm::cross(glm::dvec3(statue.axis_u_m[i]), glm::dvec3(statue.axis_v_m[i])));
    const double one_m2 = statue.area_m2[i];
    area_m2 += one_m2;
    sum_m2 += one_m2 * normal;
    volume_m3 += one_m2 * glm::dot(normal, glm::dvec3(statue.position_m[i])) / 3.0;
    for (int c = 0; c < 3; ++c)
      ASSERT_TRUE(statue.color[i][c] >= 0.0f && statue.color[i][c] <= 1.0f);
  }
  // The surface integral of the outward normal of a closed surface is zero, that of p.n / 3 its
  // volume. The areas of irregular samples are slightly wrong.
  EXPECT_LT(glm::length(sum_m2), 0.01 * area_m2);
  EXPECT_NEAR(volume_m3, 0.2, 0.05);

  // Evenly sampled, so that weights can make the kernels sum to one.
  const auto sums = kernelSums(statue, 20000, {1.0f});
  EXPECT_GT(shareWithin(sums, 0.1f, true), 0.95);
  EXPECT_GT(shareWithin(sums, 0.1f, false), 0.9);
}

TEST(SampleSolid, SpreadsTheNumberAskedForEvenlyOverASphere) {
  constexpr float kRadius_m = 0.5f;
  const glm::vec3 center(0.1f, -0.2f, 0.3f);
  const Solid ball = [&](const glm::vec3& p) { return glm::length(p - center) - kRadius_m; };
  const auto sample = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return sampleSolid(ball, {center - 0.6f, center + 0.6f, 0.05f}, 4000);
  };
  const SolidSamples samples = sample(1);
  ASSERT_EQ(samples.position_m.size(), 4000u);
  EXPECT_EQ(samples.position_m, sample(4).position_m);
  glm::vec3 mean(0.0f);
  for (std::size_t i = 0; i < samples.position_m.size(); ++i) {
    const glm::vec3 out = (samples.position_m[i] - center) / kRadius_m;
    ASSERT_NEAR(glm::length(out), 1.0f, 1e-5f);
    ASSERT_GT(glm::dot(out, samples.normal[i]), 1.0f - 1e-4f);
    mean += out / 4000.0f;
    for (std::size_t j = 0; j < i; ++j) {  // area / points is a spacing of 28 mm
      ASSERT_GT(glm::length(samples.position_m[i] - samples.position_m[j]), 0.018f);
    }
  }
  EXPECT_LT(glm::length(mean), 0.02f);
}

TEST(SampleSolid, RefusesBoundsWithoutASurface) {
  const Solid nothing = [](const glm::vec3&) { return 1.0f; };
  EXPECT_THROW(sampleSolid(nothing, {glm::vec3(0.0f), glm::vec3(1.0f), 0.1f}, 10),
               std::invalid_argument);
}

TEST(AppendSurface, IsTheSameAtAnyNumberOfThreads) {
  const auto sample = [](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const ParametricSurface bowl{
        .at = [](glm::vec2 uv) { return glm::vec3(uv.x, uv.y * uv.x, -1.0f - uv.y); },
        .paint = [](const SurfacePoint& at) { return glm::abs(at.p_world); }};
    const SampledFor audience{.eye_m = {0.0f, 0.0f, 1.0f},
                              .right = {1.0f, 0.0f, 0.0f},
                              .up = {0.0f, 1.0f, 0.0f},
                              .forward = {0.0f, 0.0f, -1.0f},
                              .half_view = glm::vec2(1.0f),
                              .step_rad = 0.005f};
    SurfelCloud cloud;
    appendSurface(cloud, bowl, audience);
    return cloud;
  };
  const SurfelCloud one = sample(1), four = sample(4);
  EXPECT_GT(one.size(), 1000u);
  EXPECT_EQ(one.position_m, four.position_m);
  EXPECT_EQ(one.axis_u_m, four.axis_u_m);
  EXPECT_EQ(one.area_m2, four.area_m2);
  EXPECT_EQ(one.color, four.color);
}

}  // namespace FOCI_FILE
}  // namespace foci
