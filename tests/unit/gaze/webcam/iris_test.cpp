#include "gaze/webcam/iris.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "gaze/webcam/cascade_tracker.h"
#include "tests/faces/face.h"

namespace foci {
namespace FOCI_FILE {

/// A dark disk between two whites and two eyelids. The edges are exact to a fraction of a pixel,
/// then blurred.
cv::Mat drawnIris(const glm::dvec2& centre_px, double radius_px) {
  constexpr int kFiner = 16;
  cv::Mat fine(60 * kFiner, 80 * kFiner, CV_8UC1, cv::Scalar(120));
  const auto at = [&](const glm::dvec2& p) {
    return cv::Point(cvRound(p.x * kFiner), cvRound(p.y * kFiner));
  };
  cv::ellipse(fine, at({40.0, 30.0}), cv::Size(22 * kFiner, 9 * kFiner), 0, 0, 360, cv::Scalar(190),
              cv::FILLED);
  cv::Mat open = fine == 190;
  cv::Mat disk(fine.size(), CV_8UC1, cv::Scalar(0));
  cv::circle(disk, at(centre_px), cvRound(radius_px * kFiner), cv::Scalar(255), cv::FILLED);
  fine.setTo(60, disk & open);
  cv::circle(disk, at(centre_px), cvRound(0.4 * radius_px * kFiner), cv::Scalar(100), cv::FILLED);
  fine.setTo(25, (disk == 100) & open);
  cv::Mat grey;
  cv::resize(fine, grey, {80, 60}, 0, 0, cv::INTER_AREA);
  cv::GaussianBlur(grey, grey, {}, 0.7);
  return grey;
}

TEST(RefineIris, IsSubPixelOnADrawnEye) {
  constexpr double kSubPixel = 0.12;
  for (const glm::dvec2 centre :
       {glm::dvec2(40.0, 30.0), glm::dvec2(36.3, 29.6), glm::dvec2(43.8, 30.9)}) {
    for (const double radius : {6.0, 9.0}) {
      const auto iris =
          refineIris(drawnIris(centre, radius), centre + glm::dvec2(1.3, -0.9), 1.05 * radius);
      ASSERT_TRUE(iris);
      EXPECT_NEAR(iris->centre_px.x, centre.x, kSubPixel) << radius;
      EXPECT_NEAR(iris->centre_px.y, centre.y, 2.0 * kSubPixel) << radius;  // lids hide half of it
      EXPECT_NEAR(iris->radius_px, radius, 0.07 * radius);
      EXPECT_GT(iris->confidence, 0.6);
    }
  }
}

TEST(RefineIris, FindsNoneOnEvenSkinOrBesideTheImage) {
  const cv::Mat even(60, 80, CV_8UC1, cv::Scalar(120));
  EXPECT_FALSE(refineIris(even, {40.0, 30.0}, 6.0));
  EXPECT_FALSE(refineIris(even, {2.0, 2.0}, 6.0));
  EXPECT_FALSE(refineIris(even, {-100.0, 1e6}, 6.0));
  EXPECT_TRUE(coarseIrises(even, {-100.0, 1e6}, {10.0, 10.0}, 6.0, 3).empty());
}

TEST(CoarseIrises, FindTheDiskFromAfar) {
  for (const double x : {32.0, 40.0, 47.0}) {
    const auto found = coarseIrises(drawnIris({x, 30.0}, 6.0), {40.0, 31.0}, {14.0, 9.0}, 6.3, 3);
    ASSERT_FALSE(found.empty());
    EXPECT_LT(glm::distance(found.front().centre_px, glm::dvec2(x, 30.0)), 1.6);
    EXPECT_EQ(found.front().score, 1.0);
  }
}

/// Share of faces whose irises are both found within 5 % of the interpupillary distance. Person,
/// place, rotation, light and gaze are random.
double shareFound(int count, bool glasses, double noise) {
  FaceFinder finder;
  int good = 0;
  for (int i = 0; i < count; ++i) {
    const auto draw = [&](std::uint32_t which, double low, double high) {
      return low + (high - low) *
                       static_cast<double>(faces::noiseAt(static_cast<std::uint32_t>(i), which, 5));
    };
    faces::Person person = faces::somebody(static_cast<std::uint32_t>(i));
    person.glasses = glasses;
    const faces::Moment moment{
        .head_m = {draw(0, -0.08, 0.08), draw(1, 0.0, 0.1), draw(2, 0.45, 0.75)},
        .yaw_rad = draw(3, -0.2, 0.2),
        .pitch_rad = draw(4, -0.12, 0.12),
        .roll_rad = draw(7, -0.12, 0.12),
        .looks_at_m = {draw(5, -0.26, 0.26), draw(6, 0.02, 0.33), 0.0}};
    faces::Photography how;
    how.noise = noise;
    how.seed = static_cast<std::uint32_t>(i);
    how.light_yaw_rad = draw(8, -1.0, 1.0);
    how.blur_px = draw(9, 0.5, 0.9);
    const faces::Face face(person);
    cv::Mat grey;
    cv::cvtColor(face.photograph(moment, how), grey, cv::COLOR_BGR2GRAY);
    const auto found = finder.find(grey);
    const faces::Truth truth = face.truthOf(moment, how);
    good += found && glm::distance((*found)[0], truth.iris_px[0]) < 0.05 * truth.eyeDistance_px() &&
            glm::distance((*found)[1], truth.iris_px[1]) < 0.05 * truth.eyeDistance_px();
  }
  return static_cast<double>(good) / count;
}

TEST(FaceFinder, FindsBothIrisesOnPlainFaces) { EXPECT_GE(shareFound(40, false, 2.0), 0.97); }

TEST(FaceFinder, FindsBothIrisesBehindGlassesAndNoise) {
  EXPECT_GE(shareFound(24, true, 5.0), 0.85);
}

TEST(FaceFinder, FindsNoFaceInNoise) {
  FaceFinder finder;
  cv::Mat noise(480, 640, CV_8UC1);
  cv::RNG(3).fill(noise, cv::RNG::UNIFORM, 0, 255);
  EXPECT_FALSE(finder.find(noise));
  EXPECT_FALSE(finder.find(cv::Mat(480, 640, CV_8UC1, cv::Scalar(128))));
}

}  // namespace FOCI_FILE
}  // namespace foci
