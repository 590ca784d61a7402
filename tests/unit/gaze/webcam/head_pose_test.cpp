#include "gaze/webcam/head_tracker.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/faces/face.h"

namespace foci {
namespace FOCI_FILE {

const Pinhole kCamera{.focal_px = {560, 560}, .principal_px = {320, 240}};

HeadPose turned(double yaw_rad, double pitch_rad, double roll_rad, const glm::dvec3& position_mm) {
  const faces::Moment moment{.yaw_rad = yaw_rad, .pitch_rad = pitch_rad, .roll_rad = roll_rad};
  return {faces::cameraFromHead(moment), position_mm};
}

std::vector<glm::dvec3> pointsOfAFace() {
  std::vector<glm::dvec3> points;
  for (double y = -50.0; y <= 70.0; y += 15.0) {
    for (double x = -50.0; x <= 50.0; x += 12.5) points.emplace_back(x, y, *faceDepth_mm(x, y));
  }
  return points;
}

TEST(FitHeadPose, IsExactWithoutNoiseAndIgnoresOutliers) {
  const std::vector<glm::dvec3> points = pointsOfAFace();
  const HeadPose truth = turned(0.2, -0.1, 0.15, {30.0, 60.0, 550.0});
  const std::vector<double> even(points.size(), 1.0);
  std::vector<glm::dvec2> image;
  for (const glm::dvec3& p : points) image.push_back(project(kCamera, truth, p));
  const HeadPose start = turned(0.05, 0.0, 0.0, {20.0, 50.0, 600.0});
  for (const bool outliers : {false, true}) {
    if (outliers) {
      for (std::size_t i = 0; i < image.size(); i += 5) image[i] += glm::dvec2(12.0, -7.0);
    }
    const auto fit = fitHeadPose(kCamera, points, image, even, start);
    ASSERT_TRUE(fit);
    constexpr double kSolver = 1e-6;
    EXPECT_LT(glm::distance(fit->pose.position_mm, truth.position_mm), 1e3 * kSolver);
    for (int column = 0; column < 3; ++column) {
      EXPECT_LT(glm::distance(fit->pose.camera_from_head[column], truth.camera_from_head[column]),
                kSolver);
    }
    EXPECT_NEAR(fit->inliers, outliers ? 0.8 : 1.0, 0.01);
    EXPECT_LT(fit->rms_px, 1e-3);
  }
}

TEST(FitHeadPose, RefusesTooFewPoints) {
  const std::vector<glm::dvec3> points = pointsOfAFace();
  const std::vector<double> even(points.size(), 1.0);
  std::vector<glm::dvec2> image;
  for (const glm::dvec3& p : points) image.push_back(project(kCamera, {}, p));
  EXPECT_FALSE(fitHeadPose(kCamera, std::span(points).first(5), std::span(image).first(5),
                           std::span(even).first(5), {}));
  EXPECT_TRUE(fitHeadPose(kCamera, points, image, even, {}));
}

TEST(OnFace, UndoesTheProjection) {
  const HeadPose pose = turned(-0.25, 0.1, 0.05, {-40.0, 20.0, 480.0});
  for (const glm::dvec3& p : pointsOfAFace()) {
    if (std::abs(p.x) < 20.0) continue;  // hidden by the nose
    const auto back = onFace_mm(kCamera, pose, project(kCamera, pose, p));
    ASSERT_TRUE(back);
    constexpr double kHalving_mm = 0.1;  // error after the half steps
    EXPECT_LT(glm::distance(*back, p), kHalving_mm) << p.x << ' ' << p.y;
  }
  EXPECT_FALSE(onFace_mm(kCamera, pose, {5.0, 5.0}));
}

}  // namespace FOCI_FILE
}  // namespace foci
