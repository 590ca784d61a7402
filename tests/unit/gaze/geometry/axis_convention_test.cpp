#include <gtest/gtest.h>

#include "gaze/sources/trace_reader.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kRounding = 1e-12;

TEST(AxisConvention, TurnsDirectionsOfUnityAndOpenCv) {
  const auto unity = AxisConvention::named("right-up-forward");
  const auto opencv = AxisConvention::named("right-down-forward");
  const auto ros = AxisConvention::named("forward-left-up");
  ASSERT_TRUE(unity && opencv && ros);
  EXPECT_EQ(unity->vector({1.0, 2.0, 3.0}), glm::dvec3(1.0, 2.0, -3.0));
  EXPECT_EQ(opencv->vector({1.0, 2.0, 3.0}), glm::dvec3(1.0, -2.0, -3.0));
  EXPECT_EQ(ros->vector({1.0, 2.0, 3.0}), glm::dvec3(-2.0, 3.0, -1.0));
}

TEST(AxisConvention, RotatesAsTheOtherFrameDoes) {
  // M (R' p') = (M R' M^T) (M p'), for a frame of either hand.
  const glm::dquat turn = glm::normalize(glm::dquat(0.7, 0.1, -0.5, 0.3));
  const glm::dvec3 p(0.2, -0.4, 0.9);
  for (const char* name : {"right-up-back", "right-up-forward", "right-down-forward",
                           "forward-left-up", "forward-right-up", "up-back-left"}) {
    const auto axes = AxisConvention::named(name);
    ASSERT_TRUE(axes) << name;
    const glm::dvec3 expected = axes->vector(turn * p);
    EXPECT_LT(glm::distance(axes->rotation(turn) * axes->vector(p), expected), kRounding) << name;
  }
}

TEST(AxisConvention, KnowsUnitysTurnToTheRight) {
  // Unity: 30 degrees about y turn its forward axis z towards x, the right.
  const auto unity = AxisConvention::named("right-up-forward");
  const glm::dquat right = glm::angleAxis(glm::radians(30.0), glm::dvec3(0.0, 1.0, 0.0));
  const glm::dvec3 sight = unity->rotation(right) * glm::dvec3(0.0, 0.0, -1.0);
  EXPECT_NEAR(sight.x, 0.5, kRounding);
  EXPECT_NEAR(sight.z, -std::sqrt(0.75), kRounding);
}

TEST(AxisConvention, RefusesOtherWords) {
  for (const char* name : {"", "right", "right-up", "right-left-up", "right-up-up", "x-y-z",
                           "right-up-back-", "right-up-back-up", "Right-up-back", "right--back"}) {
    EXPECT_FALSE(AxisConvention::named(name)) << name;
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
