#include "render/scene/procedural.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "render/optics/view.h"
#include "render/scene/sample_surface.h"
#include "render/scene/surface_query.h"

namespace foci {
namespace {

TEST(MakePlane, HasThePapersSurfelsAndItsArea) {
  const SurfelCloud plane = makePlane();
  EXPECT_EQ(plane.size(), 262144u);
  const double area = std::accumulate(plane.area_m2.begin(), plane.area_m2.end(), 0.0);
  EXPECT_NEAR(area, 4.0, 1e-4);  // float sums
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

}  // namespace
}  // namespace foci
