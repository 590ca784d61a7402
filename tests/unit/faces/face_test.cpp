#include "tests/faces/face.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "tests/faces/observer.h"

namespace foci::faces {
namespace FOCI_FILE {

Photography clean() {
  Photography how;
  how.noise = 0.0;
  how.blur_px = 0.0;
  return how;
}

/// The difference of two images: its sum and its centre of gravity.
struct Difference {
  double weight = 0.0;
  glm::dvec2 centre_px{0.0};
};

Difference between(const cv::Mat& a, const cv::Mat& b, const cv::Rect& where) {
  cv::Mat difference, grey;
  cv::absdiff(a(where), b(where), difference);
  cv::cvtColor(difference, grey, cv::COLOR_BGR2GRAY);
  const cv::Moments m = cv::moments(grey);
  if (m.m00 == 0.0) return {};
  return {m.m00, {where.x + m.m10 / m.m00 + 0.5, where.y + m.m01 / m.m00 + 0.5}};
}

cv::Rect around(const glm::dvec2& px) {
  return {static_cast<int>(px.x) - 20, static_cast<int>(px.y) - 15, 40, 30};
}

TEST(Face, IrisOfAnEyeThatLooksIntoTheCameraHidesItsCentre) {
  Person person;
  person.kappa_deg = {0.0, 0.0};
  const Face face(person);
  Moment moment{.head_m = {0.05, 0.03, 0.5}, .yaw_rad = 0.2, .pitch_rad = -0.1, .roll_rad = 0.1};
  const Truth truth = face.truthOf(moment, clean());
  constexpr double kRounding_px = 1e-9;
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_LT(glm::distance(truth.iris_px[i], truth.eye_px[i]), kRounding_px);
  }
  // 63 mm at half a metre, seen under a yaw of 0.2 rad.
  EXPECT_NEAR(truth.eyeDistance_px(), 560.0 * 0.063 / 0.5 * std::cos(0.2), 1.5);
  EXPECT_GT(truth.iris_px[0].x, truth.iris_px[1].x);  // the left eye is at the image's right
  EXPECT_GT(truth.inner_px[1].x, truth.outer_px[1].x);
}

TEST(Face, TheImageHasItsIrisesWhereTheTruthSays) {
  // Only the iris changes with its colour. The eyelids cut it above and below, so compare x alone.
  Person brown, red;
  red.iris = {0.5f, 0.1f, 0.1f};
  const Face one(brown), other(red);
  for (const double across : {-0.2, 0.0, 0.15}) {
    const Moment moment{
        .head_m = {0.02, 0.03, 0.45}, .yaw_rad = 0.1, .looks_at_m = {across, 0.02, 0.0}};
    const cv::Mat a = one.photograph(moment, clean()), b = other.photograph(moment, clean());
    const Truth truth = one.truthOf(moment, clean());
    for (std::size_t i = 0; i < 2; ++i) {
      const Difference found = between(a, b, around(truth.iris_px[i]));
      EXPECT_GT(found.weight, 0.0);
      constexpr double kRefraction_px = 0.5;  // the cornea makes the iris appear nearer
      EXPECT_NEAR(found.centre_px.x, truth.iris_px[i].x, kRefraction_px) << across;
    }
    // The rest of the image, such as the forehead, is the same.
    EXPECT_EQ(cv::norm(a(cv::Rect(0, 0, 640, 100)), b(cv::Rect(0, 0, 640, 100))), 0.0);
  }
}

TEST(Face, ShutLidsHideTheIris) {
  Person brown, red;
  red.iris = {0.5f, 0.1f, 0.1f};
  const Moment shut{.head_m = {0.0, 0.03, 0.5}, .closed = 1.0};
  const cv::Mat a = Face(brown).photograph(shut, clean()), b = Face(red).photograph(shut, clean());
  EXPECT_EQ(cv::norm(a, b), 0.0);
}

TEST(Face, ImageDoesNotDependOnTheThreads) {
  Photography how;
  how.size_px = {160, 120};
  how.focal_px = 140.0;
  const Face face(somebody(3));
  const Moment moment{.head_m = {0.0, 0.03, 0.5}};
  const cv::Mat many = face.photograph(moment, how);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(cv::norm(many, face.photograph(moment, how)), 0.0);
  how.seed = 2;
  EXPECT_GT(cv::norm(many, face.photograph(moment, how)), 0.0);
}

TEST(Face, NoiseHasTheGivenStrength) {
  Photography how;
  how.size_px = {160, 120};
  how.focal_px = 140.0;
  how.noise = 4.0;
  const Face face(somebody(0));
  const Moment moment{.head_m = {0.0, 0.03, 0.5}};
  const Photography quiet = [&] {
    Photography other = how;
    other.noise = 0.0;
    return other;
  }();
  cv::Mat noisy, pure;
  face.photograph(moment, how).convertTo(noisy, CV_32F);
  face.photograph(moment, quiet).convertTo(pure, CV_32F);
  cv::Mat middle = (pure > 118) & (pure < 138);
  cv::Mat1f off = (noisy - pure).operator cv::Mat().reshape(1, 1);
  double sum2 = 0.0, count = 0.0;
  middle = middle.reshape(1, 1);
  for (int i = 0; i < off.cols; ++i) {
    if (middle.at<unsigned char>(0, i) == 0) continue;
    sum2 += off(0, i) * off(0, i);
    ++count;
  }
  ASSERT_GT(count, 300.0);
  constexpr double kStatistical = 0.4;  // more than three standard errors
  EXPECT_NEAR(std::sqrt(sum2 / count), how.noise, kStatistical);
}

TEST(Observer, LooksAtEachTargetAfterItsLatencyAndBlinks) {
  Sitting sitting;
  const Observer observer(sitting, {{0.0, 1.0, {0.1, 0.05}}, {1.0, 2.0, {-0.2, 0.0}}});
  const auto looksAt = [&](double time_s, const glm::dvec2& point_m) {
    EXPECT_LT(glm::distance(observer.at(time_s).looks_at_m, onScreen_m(sitting, point_m)), 1e-12);
  };
  looksAt(0.5, {0.1, 0.05});
  looksAt(1.1, {0.1, 0.05});
  looksAt(1.5, {-0.2, 0.0});
  int blinks = 0;
  for (double t = 0.0; t < 40.0; t += 0.01) {
    blinks += observer.closedAt(t) > 0.9 && observer.closedAt(t - 0.01) <= 0.9;
  }
  EXPECT_EQ(blinks, 10);
}

}  // namespace FOCI_FILE
}  // namespace foci::faces
