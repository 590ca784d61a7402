#include "app/live/pose.h"

#include <gtest/gtest.h>

#include <cmath>

namespace foci {
namespace FOCI_FILE {

TEST(LivePose, AStepIsAShareOfTheScene) {
  EXPECT_DOUBLE_EQ(liveStep_m(12.0), 2.0 * liveStep_m(6.0));
  EXPECT_DOUBLE_EQ(liveStep_m(6.0), 0.05);  // the gallery
  EXPECT_GT(liveStep_m(0.0), 0.0);          // not loaded yet
}

TEST(LivePose, MovesLevelAndTurnsAroundTheEye) {
  LivePose pose({0, 1, 0}, {0, 0.5, -2}, {0, 1, 0});
  constexpr double kRounding = 1e-12;
  pose.move({0.0, 0.0, 0.5});
  EXPECT_NEAR(glm::distance(pose.position_m(), glm::dvec3(0, 1, -0.5)), 0.0, kRounding);
  EXPECT_NEAR(glm::distance(pose.look_at_m(), glm::dvec3(0, 0.5, -2.5)), 0.0, kRounding);
  const double away_m = glm::distance(pose.position_m(), pose.look_at_m());
  pose.turn({0.1, 0.0});
  EXPECT_GT(pose.look_at_m().x, 0.0);
  EXPECT_NEAR(glm::distance(pose.position_m(), pose.look_at_m()), away_m, kRounding);
  for (int i = 0; i < 100; ++i) pose.turn({0.0, 0.3});  // never over the head
  EXPECT_LT(std::abs(glm::normalize(pose.look_at_m() - pose.position_m()).y), 0.99);
  pose.reset();
  EXPECT_EQ(pose.look_at_m(), glm::dvec3(0, 0.5, -2));
}

}  // namespace FOCI_FILE
}  // namespace foci
