#include "gaze/eye/close_up.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <vector>

#include "tests/unit/gaze/scratch.h"

namespace foci {
namespace {

/// Sclera, iris, pupil and glint, drawn four times as large and shrunk, so that edges are exact to
/// a fraction of a pixel; then blur and noise.
cv::Mat drawnEye(const cv::Point2d& centre, const cv::Size2d& radii, double angle_deg) {
  constexpr int kFiner = 4;
  cv::Mat fine(480 * kFiner, 640 * kFiner, CV_8UC1, cv::Scalar(150));
  const auto at = [&](const cv::Point2d& p) {
    return cv::Point(cvRound(p.x * kFiner), cvRound(p.y * kFiner));
  };
  const auto size = [&](double x, double y) {
    return cv::Size(cvRound(x * kFiner), cvRound(y * kFiner));
  };
  cv::ellipse(fine, at(centre), size(150, 110), 0, 0, 360, cv::Scalar(190), cv::FILLED);
  cv::ellipse(fine, at(centre), size(95, 95), 0, 0, 360, cv::Scalar(75), cv::FILLED);
  cv::ellipse(fine, at(centre), size(radii.width, radii.height), angle_deg, 0, 360, cv::Scalar(25),
              cv::FILLED);
  cv::ellipse(fine, at(centre + cv::Point2d(-8, 4)), size(5, 5), 0, 0, 360, cv::Scalar(255),
              cv::FILLED);
  cv::Mat grey;
  cv::resize(fine, grey, {640, 480}, 0, 0, cv::INTER_AREA);
  cv::GaussianBlur(grey, grey, {5, 5}, 1.0);
  cv::Mat noise(grey.size(), CV_16SC1), noisy;
  cv::RNG random(7);
  random.fill(noise, cv::RNG::NORMAL, 0, 3);
  grey.convertTo(noisy, CV_16SC1);
  noisy += noise;
  noisy.convertTo(grey, CV_8UC1);
  return grey;
}

TEST(FindCloseUpPupil, IsSubPixelOnADrawnEye) {
  for (const double x : {250.25, 320.5, 400.75}) {
    for (const double shorter : {22.0, 34.0}) {
      const auto pupil = findCloseUpPupil(drawnEye({x, 240.5}, {36, shorter}, 30));
      ASSERT_TRUE(pupil) << x;
      constexpr double kSubPixel = 0.25, kEdge = 0.7;
      EXPECT_NEAR(pupil->centre_px.x, x, kSubPixel);
      EXPECT_NEAR(pupil->centre_px.y, 240.5, kSubPixel);
      EXPECT_NEAR(pupil->radii_px.x, 36, kEdge);
      EXPECT_NEAR(pupil->radii_px.y, shorter, kEdge);
      EXPECT_GT(pupil->confidence, 0.85);
      if (shorter < 30) {
        const double angle_deg = pupil->angle_rad * 180.0 / std::numbers::pi;
        EXPECT_NEAR(std::remainder(angle_deg - 30.0, 180.0), 0.0, 2.0);
      }
      EXPECT_LT(glm::distance(*pupil->glint_px, glm::dvec2(x - 8, 244.5)), 0.7);
    }
  }
}

TEST(FindCloseUpPupil, SeesNoneInAnEmptyOrEvenImage) {
  EXPECT_FALSE(findCloseUpPupil(cv::Mat(480, 640, CV_8UC1, cv::Scalar(0))));
  EXPECT_FALSE(findCloseUpPupil(cv::Mat(480, 640, CV_8UC1, cv::Scalar(255))));
  cv::Mat noise(480, 640, CV_8UC1);
  cv::RNG(3).fill(noise, cv::RNG::UNIFORM, 0, 255);
  const auto pupil = findCloseUpPupil(noise);
  EXPECT_TRUE(!pupil || pupil->confidence < 0.5);
  EXPECT_FALSE(findCloseUpPupil(cv::Mat(32, 32, CV_8UC1, cv::Scalar(9))));
}

TEST(BlinkCounter, CountsClosuresOfABlinksLength) {
  BlinkCounter counter;
  const auto close = [&](double from_s, double to_s) {
    for (double time_s = from_s - 0.3; time_s < to_s + 0.3; time_s += 0.01) {
      counter.push(time_s, time_s > from_s && time_s < to_s ? 0.1 : 0.9);
    }
  };
  close(1.0, 1.2);
  EXPECT_EQ(counter.blinks(), 1);
  close(2.0, 2.02);  // a flicker of the detector
  EXPECT_EQ(counter.blinks(), 1);
  close(3.0, 5.0);  // shut
  EXPECT_EQ(counter.blinks(), 1);
  EXPECT_FALSE(counter.closed());
}

TEST(FindCloseUpPupil, FollowsARealEyeThroughThreeBlinks) {
  const auto file = gazeData().parent_path() / "eye" / "short_human_3blink.mp4";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is absent";
  cv::VideoCapture video(file.string());
  ASSERT_TRUE(video.isOpened());
  constexpr double kRate_Hz = 77.86;
  BlinkCounter counter;
  cv::Mat frame, grey;
  std::vector<double> steps_px;
  std::optional<glm::dvec2> before;
  int frames = 0, open = 0, found = 0;
  while (video.read(frame)) {
    cv::cvtColor(frame, grey, cv::COLOR_BGR2GRAY);
    const auto pupil = findCloseUpPupil(grey);
    counter.push(frames++ / kRate_Hz, pupil ? pupil->confidence : 0.0);
    const bool seen = pupil && pupil->confidence > 0.35;  // or covered by the lid
    open += !counter.closed();
    found += !counter.closed() && seen;
    if (seen && before) steps_px.push_back(glm::distance(pupil->centre_px, *before));
    before = seen ? std::optional(pupil->centre_px) : std::nullopt;
  }
  EXPECT_EQ(frames, 284);
  EXPECT_EQ(counter.blinks(), 3);
  EXPECT_GE(found, open * 99 / 100);
  EXPECT_GT(open, 210);
  std::nth_element(steps_px.begin(), steps_px.begin() + steps_px.size() / 2, steps_px.end());
  EXPECT_LT(steps_px[steps_px.size() / 2], 1.0);
}

}  // namespace
}  // namespace foci
