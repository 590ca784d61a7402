#include "gaze/webcam/webcam_source.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "base/input_error.h"
#include "tests/faces/face.h"
#include "tests/unit/calibration/camera/brown.h"

namespace foci {
namespace FOCI_FILE {

const Lens kLens{{.focal_px = {560, 560}, .principal_px = {322, 238}},
                 {-0.25, 0.08, 0.001, -0.002, 0.0},
                 {640, 480}};

TEST(StraightFrames, ShowAPointWhereAPinholeWould) {
  CameraModel camera{.size_px = kLens.size_px,
                     .focal_px = kLens.focal_px,
                     .principal_px = kLens.principal_px,
                     .distortion = kLens.distortion};
  for (const glm::dvec2& along :
       {glm::dvec2(0.4, 0.3), glm::dvec2(-0.45, 0.1), glm::dvec2(0.0, 0.0)}) {
    // Draw a blurred dot where the real lens shows the point.
    const glm::dvec2 at_px = projectByCamera(camera, glm::dvec3(along, 1.0));
    cv::Mat1b frame(480, 640);
    for (int y = 0; y < frame.rows; ++y) {
      for (int x = 0; x < frame.cols; ++x) {
        const double far = glm::distance(glm::dvec2(x + 0.5, y + 0.5), at_px);
        frame(y, x) = static_cast<unsigned char>(std::lround(250.0 * std::exp(-far * far / 18.0)));
      }
    }
    StraightFrames frames(kLens);
    const cv::Mat1b straight = frames.of(frame);
    glm::dvec2 sum(0.0);
    double weight = 0.0;
    for (int y = 0; y < straight.rows; ++y) {
      for (int x = 0; x < straight.cols; ++x) {
        sum += static_cast<double>(straight(y, x)) * glm::dvec2(x + 0.5, y + 0.5);
        weight += straight(y, x);
      }
    }
    const glm::dvec2 wanted = kLens.focal_px * along + kLens.principal_px;
    constexpr double kImage_px = 0.15;  // distortion stretches the dot unevenly
    EXPECT_NEAR(glm::distance(sum / weight, wanted), 0.0, kImage_px) << along.x;
  }
}

TEST(StraightFrames, DoNotChangeAPinholesFramesAndRefuseAnotherSize) {
  Lens lens = kLens;
  lens.distortion = {};
  const cv::Mat1b frame(480, 640, static_cast<unsigned char>(7)), small(240, 320);
  StraightFrames frames(lens);
  EXPECT_EQ(frames.of(frame).data, frame.data);
  EXPECT_THROW(frames.of(small), InputError);
}

TEST(WebcamTracker, RefusesTheReferenceOfTheOtherTracker) {
  WebcamReference reference;
  reference.camera = kLens;
  reference.by_networks = FaceNetworks::missing().empty();
  EXPECT_NO_THROW(WebcamTracker(std::nullopt, reference));
  reference.by_networks = !reference.by_networks;
  EXPECT_THROW(WebcamTracker(std::nullopt, reference), InputError);
}

TEST(WebcamTracker, TakesGreyAndColour) {
  const faces::Face face(faces::somebody(1));
  const cv::Mat image = face.photograph({.head_m = {0.0, 0.0, 0.6}}, faces::Photography{});
  cv::Mat grey;
  cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  EXPECT_TRUE(WebcamTracker(Lens{kLens, {}, {}}).push(image).face);
  EXPECT_TRUE(WebcamTracker(Lens{kLens, {}, {}}).push(grey).face);
}

}  // namespace FOCI_FILE
}  // namespace foci
