#include "gaze/geometry/gaze_sample.h"

#include <gtest/gtest.h>

#include "gaze/geometry/line_of_sight.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kHalfPixel_deg = 0.03;  // at the side of the view, where pixels are coarse

TEST(HeadsetScreen, EndsWhereTheFieldDoes) {
  const EyeField field{.left_deg = 54.0, .right_deg = 40.0, .up_deg = 42.0, .down_deg = 53.0};
  const Screen screen = headsetScreen(field, 20.0);
  EXPECT_EQ(screen.size_px % 2, glm::ivec2(0));
  const glm::dvec2 low = eccentricity_deg(screen, {0.0, screen.size_px.y});
  const glm::dvec2 high = eccentricity_deg(screen, {screen.size_px.x, 0.0});
  EXPECT_NEAR(low.x, -54.0, kHalfPixel_deg);
  EXPECT_NEAR(low.y, -53.0, kHalfPixel_deg);
  EXPECT_NEAR(high.x, 40.0, kHalfPixel_deg);
  EXPECT_NEAR(high.y, 42.0, kHalfPixel_deg);
}

TEST(HeadsetScreen, HasItsPixelsPerDegreeStraightAhead) {
  const Screen screen = headsetScreen({.left_deg = 54.0, .right_deg = 40.0}, 20.0);
  const auto ahead = pointOnScreen_px(screen, {0.0, 0.0, -1.0});
  const auto aside = pointOnScreen_px(screen, {std::tan(glm::radians(0.1)), 0.0, -1.0});
  ASSERT_TRUE(ahead && aside);
  EXPECT_NEAR(glm::distance(*ahead, *aside), 2.0, 1e-4);
  EXPECT_LT(glm::distance(lineOfSight(screen, *ahead), glm::dvec3(0.0, 0.0, -1.0)), 1e-12);
}

TEST(FieldOfBothEyes, IsTheUnion) {
  const EyeField both = fieldOfBothEyes({.left_deg = 54.0, .right_deg = 40.0});
  EXPECT_EQ(both.left_deg, 54.0);
  EXPECT_EQ(both.right_deg, 54.0);
}

TEST(PointSeenBy, StaysInTheWorldWhileTheHeadTurns) {
  const Screen screen = headsetScreen({}, 12.0);
  GazeSample before{.point_px = pointOnScreen_px(screen, {0.1, 0.2, -1.0}), .head = HeadInWorld{}};
  GazeSample now = before;
  now.head->world_from_head = glm::angleAxis(glm::radians(20.0), glm::dvec3(0.0, 1.0, 0.0));
  const auto point_px = pointSeenBy_px(now, before, screen);
  ASSERT_TRUE(point_px);
  const glm::dvec3 sight = now.head->world_from_head * lineOfSight(screen, *point_px);
  EXPECT_LT(glm::distance(sight, *sightInWorld(before, screen)), 1e-12);
  now.head->world_from_head = glm::angleAxis(glm::radians(170.0), glm::dvec3(0.0, 1.0, 0.0));
  EXPECT_FALSE(pointSeenBy_px(now, before, screen));
}

}  // namespace FOCI_FILE
}  // namespace foci
