#include "gaze/geometry/line_of_sight.h"

#include <gtest/gtest.h>

#include <cmath>

namespace foci {
namespace FOCI_FILE {

constexpr double kRounding = 1e-9;  // a handful of double operations on pixels and degrees

const Screen kScreen{.size_px = {1024, 768}, .size_m = {0.38, 0.30}, .distance_m = 0.67};

TEST(LineOfSight, ThroughTheCentreIsStraightAhead) {
  EXPECT_EQ(lineOfSight(kScreen, {512, 384}), glm::dvec3(0, 0, -1));
}

TEST(LineOfSight, PointsRightAndUpForARightUpperPoint) {
  const glm::dvec3 corner = lineOfSight(kScreen, {1024, 0});
  const glm::dvec3 expected = glm::normalize(glm::dvec3(0.19, 0.15, -0.67));
  EXPECT_LT(glm::distance(corner, expected), kRounding);
}

TEST(LineOfSight, RoundTripsWithScreenPointAndEccentricity) {
  for (const glm::dvec2 point_px : {glm::dvec2(0, 0), {512.5, 384.5}, {-300, 900}, {1e4, 7}}) {
    const auto back = pointOnScreen_px(kScreen, lineOfSight(kScreen, point_px));
    ASSERT_TRUE(back);
    EXPECT_LT(glm::distance(*back, point_px), 1e4 * kRounding);
    const auto there = pointAtEccentricity_px(kScreen, eccentricity_deg(kScreen, point_px));
    EXPECT_LT(glm::distance(there, point_px), 1e4 * kRounding);
  }
}

TEST(LineOfSight, AwayFromTheScreenMeetsNoPoint) {
  EXPECT_FALSE(pointOnScreen_px(kScreen, {0, 0, 1}));
  EXPECT_FALSE(pointOnScreen_px(kScreen, {1, 0, 0}));
}

TEST(LineOfSight, EccentricityIsTheArcTangentWithYUp) {
  const glm::dvec2 deg = eccentricity_deg(kScreen, {1024, 0});
  EXPECT_NEAR(deg.x, 15.83239, 5e-5);  // atan(0.19 / 0.67)
  EXPECT_NEAR(deg.y, 12.61933, 5e-5);  // atan(0.15 / 0.67)
}

TEST(LineOfSight, AngleIsZeroToItselfAndThatOfTheDirections) {
  EXPECT_EQ(angleBetween_deg(kScreen, {100, 200}, {100, 200}), 0.0);
  EXPECT_NEAR(angleBetween_deg(kScreen, {0, 384}, {1024, 384}), 2 * 15.83239, 1e-4);
  const glm::dvec3 a = lineOfSight(kScreen, {10, 20}), b = lineOfSight(kScreen, {800, 700});
  EXPECT_NEAR(angleBetween_deg(kScreen, {10, 20}, {800, 700}),
              glm::degrees(std::acos(glm::dot(a, b))), kRounding);
}

}  // namespace FOCI_FILE
}  // namespace foci
