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

constexpr double kPrecision = 1e-9;
const LivePose kStart({0, 1, 0}, {0, 1, -2}, {0, 1, 0});

TEST(LivePose, OrbitsAroundThePointItFaces) {
  LivePose pose = kStart;
  pose.orbit({0.3, 0.2});
  EXPECT_NEAR(glm::distance(pose.look_at_m(), glm::dvec3(0, 1, -2)), 0.0, kPrecision);
  EXPECT_NEAR(pose.away_m(), 2.0, kPrecision);
  EXPECT_LT(pose.position_m().x, 0.0);  // it looks to the right, from the left
  EXPECT_GT(pose.position_m().y, 1.0);  // and downwards, from above
}

TEST(LiveSteering, WalksAtASpeedThatFitsTheScene) {
  const auto after_s = [](double scene_m, bool fast, int frames) {
    LiveSteering steering(kStart);
    for (int i = 0; i < frames; ++i) {
      steering.steer({.walk = {0, 0, 1}, .fast = fast, .passed_s = 1.0 / frames}, scene_m, 0.1 * i);
    }
    return -steering.pose().position_m().z;
  };
  EXPECT_NEAR(after_s(6.0, false, 60), 1.0, kPrecision);  // a sixth of the scene in a second
  EXPECT_NEAR(after_s(6.0, false, 25), 1.0, kPrecision);  // at any frame rate
  EXPECT_NEAR(after_s(600.0, false, 60), 100.0, 1e-6);
  EXPECT_NEAR(after_s(6.0, true, 60), 4.0, kPrecision);
}

TEST(LiveSteering, PanKeepsThePointUnderTheMouse) {
  LiveSteering steering(kStart);
  steering.steer({.drag = Drag::pan, .drag_px = {100, 50}, .tangent_per_px = 0.001}, 6.0, 0.0);
  // The plane at the point that the eye faces is 2 m away: 100 px are 0.2 m there.
  EXPECT_NEAR(steering.pose().position_m().x, -0.2, kPrecision);
  EXPECT_NEAR(steering.pose().position_m().y, 1.1, kPrecision);
}

TEST(LiveSteering, UndoesOneChangeAfterTheOther) {
  LiveSteering steering(kStart);
  EXPECT_FALSE(steering.undo());
  EXPECT_FALSE(steering.steer({.passed_s = 0.1}, 6.0, 0.0));  // nothing was done
  for (int i = 0; i < 10; ++i) {                              // one change
    EXPECT_TRUE(steering.steer({.walk = {1, 0, 0}, .passed_s = 0.1}, 6.0, 0.1 * i));
  }
  const glm::dvec3 beside_m = steering.pose().position_m();
  steering.steer({.wheel = 1.0}, 6.0, 5.0);
  EXPECT_NE(steering.pose().position_m(), beside_m);
  steering.reset(5.1);
  EXPECT_EQ(steering.pose().position_m(), kStart.position_m());
  EXPECT_TRUE(steering.undo());
  EXPECT_TRUE(steering.undo());
  EXPECT_EQ(steering.pose().position_m(), beside_m);
  EXPECT_TRUE(steering.undo());
  EXPECT_EQ(steering.pose().position_m(), kStart.position_m());
  EXPECT_FALSE(steering.undo());
}

}  // namespace FOCI_FILE
}  // namespace foci
