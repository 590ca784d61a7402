// The report's view of the scene: its frame, its points, and their plan.
#include "app/replay/scene_view.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "render/scene/gaussian_cloud.h"

namespace foci {
namespace FOCI_FILE {

constexpr float kRounding_m = 1e-4f;

/// A wall across the line of sight along +y, 2 m away, with z upwards; a point far behind it.
Scene wallOf(int n) {
  SurfelCloud cloud;
  for (int i = 0; i < n * n; ++i) {
    const float x = static_cast<float>(i % n) / static_cast<float>(n) - 0.5f;
    const float z = static_cast<float>(i / n) / static_cast<float>(n) - 0.5f;
    appendSurfel(cloud, {x, 2.0f, z}, {0.0f, -1.0f, 0.0f}, 0.01f, 1e-4f,
                 glm::vec3(1.0f, 0.0f, 0.0f));
  }
  appendSurfel(cloud, {0.0f, 900.0f, 0.0f}, {0.0f, -1.0f, 0.0f}, 0.01f, 1e-4f, glm::vec3(1.0f));
  return {cloud};
}

/// Gaze rests on the wall's right, and once meets nothing.
GazeInScene gazeOnTheRight() {
  const SightHit hit{.point_m = {0.2, 2.0, 0.0}, .distance_m = 2.0, .normal = {0.0, -1.0, 0.0}};
  GazeInScene gaze;
  gaze.up = {0.0, 0.0, 1.0};
  gaze.samples = {{.time_s = 5.0,
                   .lasts_s = 1.0,
                   .valid = true,
                   .origin_m = {0.2, 0.0, 0.0},
                   .direction = {0.0, 1.0, 0.0},
                   .hit = hit},
                  {.time_s = 6.0, .lasts_s = 1.0, .origin_m = {0.2, 0.0, 0.1}}};
  gaze.fixations = {{.onset_s = 4.0, .duration_s = 0.2},
                    {.onset_s = 5.0, .duration_s = 0.5, .hit = hit, .direction = {0.0, 1.0, 0.0}}};
  return gaze;
}

TEST(SceneView, LooksFromBehindTheObserver) {
  const auto view = sceneViewOf(wallOf(10), gazeOnTheRight());
  ASSERT_TRUE(view);
  ASSERT_EQ(view->path.size(), 2u);
  EXPECT_LT(glm::distance(view->path[0].eye_m, {0.0f, 0.0f, 2.0f}), kRounding_m);
  EXPECT_LT(glm::distance(view->path[0].point_m, glm::vec3(0.0f)), kRounding_m);
  EXPECT_LT(glm::distance(view->path[1].eye_m, {0.0f, 0.1f, 2.0f}), kRounding_m);
  EXPECT_TRUE(std::isnan(view->path[1].point_m.x));
  ASSERT_EQ(view->fixations.size(), 1u);
  EXPECT_EQ(view->fixations[0].number, 2u);
  EXPECT_LT(glm::distance(view->fixations[0].eye_m, {0.0f, 0.0f, 2.0f}), kRounding_m);
  EXPECT_LT(glm::distance(view->fixations[0].normal, {0.0f, 0.0f, 1.0f}), kRounding_m);
}

TEST(SceneView, LeavesOutWhatIsFar) {
  const auto view = sceneViewOf(wallOf(10), gazeOnTheRight());
  EXPECT_EQ(view->points.size(), 100u);
  EXPECT_EQ(view->points_all, 101u);
  EXPECT_EQ(view->points[0].color, glm::u8vec3(255, 0, 0));
}

TEST(SceneView, ShowsAPointAsOftenAsItIsOpaque) {
  auto cloud = std::get<SurfelCloud>(wallOf(100).splats);
  cloud.opacity.assign(cloud.size(), 0.15f);
  const auto view = sceneViewOf({cloud}, gazeOnTheRight());
  EXPECT_EQ(view->points_near, 10'000u);
  EXPECT_NEAR(static_cast<double>(view->points.size()), 1500.0, 15.0);
}

TEST(SceneView, ThinsEvenly) {
  const auto view = sceneViewOf(wallOf(700), gazeOnTheRight());
  EXPECT_EQ(view->points_near, 490'000u);
  EXPECT_NEAR(static_cast<double>(view->points.size()), static_cast<double>(kMaxViewPoints), 2.0);
  // Each hundredth of the wall has its share, within a fifth.
  std::vector<int> counts(100);
  for (const SceneView::Point& point : view->points) {
    const int x = static_cast<int>(10.0f * (point.at_m.x + 0.7f) + 1e-3f);
    const int y = static_cast<int>(10.0f * (point.at_m.y + 0.5f) + 1e-3f);
    ++counts[static_cast<std::size_t>(10 * std::clamp(y, 0, 9) + std::clamp(x, 0, 9))];
  }
  EXPECT_GT(*std::ranges::min_element(counts), 1600);
  EXPECT_LT(*std::ranges::max_element(counts), 2400);
}

TEST(SceneView, ShowsGaussians) {
  GaussianCloud cloud;
  cloud.position_m = {{0.2f, 2.0f, 0.0f}};
  cloud.covariance_m2 = {covarianceOf({0.1f, 0.1f, 0.0f}, {0.0f, 0.0f, 0.0f, 1.0f})};
  cloud.opacity = {1.0f};
  cloud.color = {{0.0f, 1.0f, 2.0f}};
  const auto view = sceneViewOf({cloud}, gazeOnTheRight());
  ASSERT_EQ(view->points.size(), 1u);
  EXPECT_EQ(view->points[0].color, glm::u8vec3(0, 255, 255));
  EXPECT_NEAR(view->points[0].radius_m, 0.1f, kRounding_m);
}

TEST(SceneView, IsAbsentIfNoGazeMetTheScene) {
  GazeInScene gaze = gazeOnTheRight();
  gaze.samples.erase(gaze.samples.begin());
  EXPECT_FALSE(sceneViewOf(wallOf(10), gaze));
}

TEST(ScenePlan, HasAScaleAndNumberedFixations) {
  const auto view = sceneViewOf(wallOf(10), gazeOnTheRight());
  for (const SceneSide side : {SceneSide::above, SceneSide::right}) {
    const std::string svg = scenePlanSvg(*view, side);
    EXPECT_NE(svg.find(">2</text>"), std::string::npos);
    EXPECT_NE(svg.find(">0.5 m</text>"), std::string::npos) << svg.substr(svg.size() - 300);
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
