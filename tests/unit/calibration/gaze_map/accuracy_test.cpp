#include "calibration/gaze_map/gaze_report.h"

#include <gtest/gtest.h>

#include <cmath>

namespace foci {
namespace FOCI_FILE {

constexpr double kRounding = 1e-9;
const GazeFrame kPlane{.units = MapUnits::direction, .screen = {}};

/// The point of the plane z = 1 at `deg` to the right.
glm::dvec2 right(double deg) { return {std::tan(glm::radians(deg)), 0.0}; }

TEST(Accuracy, IsTheMeanAngleAndPrecisionItsClosedForm) {
  const std::vector<GazePair> pairs{{right(1.0), right(0.0), {}, 1.0},
                                    {right(2.8), right(0.0), {}, 1.0},
                                    {std::nullopt, right(0.0), {}, 1.0},
                                    {right(10.5), right(10.0), {}, 1.0}};
  const GazeAccuracy found = measureAccuracy(pairs, kPlane, nullptr);
  EXPECT_NEAR(*found.overall.accuracy_deg, (1.0 + 2.8 + 0.5) / 3.0, kRounding);
  EXPECT_NEAR(found.overall.axes_deg->x, *found.overall.accuracy_deg, kRounding);
  EXPECT_NEAR(found.overall.axes_deg->y, 0.0, kRounding);
  EXPECT_NEAR(*found.worst_deg, 1.9, kRounding);
  // The one pair of neighbours at one target.
  EXPECT_NEAR(*found.overall.rms_s2s_deg, 1.8, kRounding);
  EXPECT_EQ(found.overall.samples, 4u);
  EXPECT_EQ(found.overall.missing, 1u);
  EXPECT_EQ(found.targets.size(), 2u);
  EXPECT_FALSE(found.targets[1].measures.rms_s2s_deg);
  EXPECT_EQ(gradeOf(found), Grade::fair);
}

TEST(Accuracy, DataLossBreaksTheSequence) {
  const std::vector<GazePair> pairs{{right(0.0), right(0.0), {}, 1.0},
                                    {std::nullopt, right(0.0), {}, 1.0},
                                    {right(2.0), right(0.0), {}, 1.0}};
  EXPECT_FALSE(measureAccuracy(pairs, kPlane, nullptr).overall.rms_s2s_deg);
}

TEST(Accuracy, NothingMeasuredIsPoor) {
  const std::vector<GazePair> lost{{std::nullopt, right(0.0), {}, 1.0}};
  const GazeAccuracy found = measureAccuracy(lost, kPlane, nullptr);
  EXPECT_FALSE(found.overall.accuracy_deg);
  EXPECT_EQ(gradeOf(found), Grade::poor);
}

TEST(MapUnits, AgreeOnOneScreen) {
  const Screen screen = defaultScreen();
  for (const MapUnits units : {MapUnits::deg, MapUnits::norm, MapUnits::direction}) {
    const GazeFrame frame{.units = units, .screen = screen};
    for (const glm::dvec2 px : {glm::dvec2(0, 0), glm::dvec2(960, 540), glm::dvec2(1700, 33)}) {
      const glm::dvec2 back = toPixels(frame, screen, fromPixels(frame, screen, px));
      EXPECT_NEAR(glm::length(back - px), 0.0, 1e-6) << nameOf(units);
      const glm::dvec2 plane = onPlane(frame, fromPixels(frame, screen, px));
      EXPECT_NEAR(plane.x, (px.x / 1920 - 0.5) * screen.size_m.x / screen.distance_m, kRounding);
      EXPECT_NEAR(plane.y, (0.5 - px.y / 1080) * screen.size_m.y / screen.distance_m, kRounding);
    }
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
