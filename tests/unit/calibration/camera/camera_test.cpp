#include "calibration/camera/fit_camera.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <random>

#include "base/input_error.h"
#include "tests/unit/calibration/camera/brown.h"

namespace foci {
namespace FOCI_FILE {

const CameraModel kTruth{.size_px = {640, 480},
                         .focal_px = {612.0, 608.0},
                         .principal_px = {325.0, 236.0},
                         .distortion = {-0.12, 0.05, 0.001, -0.0008, 0.0},
                         .focal_sd_px = {},
                         .rms_px = 0.0};

/// Boards seen at tilts and places drawn at random.
std::vector<BoardView> viewsOf(int count, double noise_px, bool tilted, std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::normal_distribution<double> gauss;
  std::vector<BoardView> views;
  for (int v = 0; v < count; ++v) {
    glm::dmat4 pose = glm::translate(
        glm::dmat4(1.0),
        {0.04 * uniform(random), 0.03 * uniform(random), 0.4 + 0.1 * uniform(random)});
    if (tilted) {
      pose = glm::rotate(pose, 0.6 * uniform(random), {1, 0, 0});
      pose = glm::rotate(pose, 0.6 * uniform(random), {0, 1, 0});
      pose = glm::rotate(pose, 0.5 * uniform(random), {0, 0, 1});
    }
    BoardView view;
    for (int y = 0; y < 6; ++y) {
      for (int x = 0; x < 9; ++x) {
        const glm::dvec2 board = 0.025 * glm::dvec2(x, y);
        const glm::dvec3 p(pose * glm::dvec4(board.x - 0.1, board.y - 0.0625, 0.0, 1.0));
        view.board_m.push_back(board);
        view.image_px.push_back(projectByCamera(kTruth, p) +
                                noise_px * glm::dvec2{gauss(random), gauss(random)});
      }
    }
    views.push_back(std::move(view));
  }
  return views;
}

TEST(FitCamera, RecoversAKnownCamera) {
  std::mt19937_64 random(1);
  const CameraModel found = fitCamera(viewsOf(10, 0.0, true, random), kTruth.size_px).camera;
  constexpr double kSolver_px = 0.01;  // corners pass through float on the way to the start only
  EXPECT_NEAR(found.focal_px.x, kTruth.focal_px.x, kSolver_px);
  EXPECT_NEAR(found.focal_px.y, kTruth.focal_px.y, kSolver_px);
  EXPECT_NEAR(found.principal_px.x, kTruth.principal_px.x, kSolver_px);
  EXPECT_NEAR(found.principal_px.y, kTruth.principal_px.y, kSolver_px);
  EXPECT_NEAR(found.distortion[0], kTruth.distortion[0], 1e-3);
  EXPECT_LT(found.rms_px, kSolver_px);
}

TEST(FitCamera, StatesItsDeviationUnderNoise) {
  std::mt19937_64 random(2);
  const CameraModel found = fitCamera(viewsOf(12, 0.3, true, random), kTruth.size_px).camera;
  EXPECT_NEAR(found.rms_px, 0.3 * std::sqrt(2.0), 0.05);
  EXPECT_GT(found.focal_sd_px.x, 0.0);
  EXPECT_LT(std::abs(found.focal_px.x - kTruth.focal_px.x), 4.0 * found.focal_sd_px.x);
}

TEST(FitCamera, RefusesTooFewViewsAndABoardThatNeverTilts) {
  std::mt19937_64 random(3);
  EXPECT_THROW(fitCamera(viewsOf(2, 0.1, true, random), kTruth.size_px), InputError);
  EXPECT_THROW(fitCamera(viewsOf(5, 0.1, false, random), kTruth.size_px), InputError);
}

TEST(FindBoard, FindsTheCornersOfADrawnChessboard) {
  constexpr int kSquare_px = 40;
  cv::Mat image(480, 640, CV_8UC1, cv::Scalar(255));
  for (int y = 0; y < 7; ++y) {
    for (int x = 0; x < 10; ++x) {
      if ((x + y) % 2 == 0) {
        cv::rectangle(image, {100 + x * kSquare_px, 90 + y * kSquare_px, kSquare_px, kSquare_px},
                      cv::Scalar(0), cv::FILLED);
      }
    }
  }
  const auto view = findBoard(image, {});
  ASSERT_TRUE(view);
  ASSERT_EQ(view->image_px.size(), 54u);
  for (std::size_t i = 0; i < view->image_px.size(); ++i) {
    // Either end of the board may come first.
    const glm::dvec2 steps = view->board_m[i] / 0.025;
    const glm::dvec2 forwards = glm::dvec2(140, 130) + 40.0 * steps;
    const glm::dvec2 backwards = glm::dvec2(140, 130) + 40.0 * (glm::dvec2(8, 5) - steps);
    const double off = std::min(glm::length(view->image_px[i] - forwards),
                                glm::length(view->image_px[i] - backwards));
    EXPECT_LT(off, 0.1);
  }
  EXPECT_FALSE(findBoard(cv::Mat(480, 640, CV_8UC1, cv::Scalar(128)), {}));
}

}  // namespace FOCI_FILE
}  // namespace foci
