#include "gaze/focus/accommodation.h"

#include <gtest/gtest.h>

#include <cmath>

namespace foci {
namespace FOCI_FILE {

constexpr double kRounding = 1e-12;  // a few double operations and one exponential, in dioptres

const AccommodationSettings kEye{.latency_s = 0.3, .time_constant_s = 0.2};

TEST(Accommodation, RestsUntilTheFirstTargetAndStartsThere) {
  Accommodation eye({.resting_D = 1.25});
  EXPECT_EQ(eye.focusAt_D(0.0), 1.25);
  EXPECT_EQ(eye.focusAt_D(5.0), 1.25);
  EXPECT_FALSE(eye.target_D());
  eye.setTarget(6.0, 3.0);
  EXPECT_EQ(eye.focusAt_D(6.0), 3.0);
  EXPECT_EQ(eye.target_D(), 3.0);
}

TEST(Accommodation, AnswersAStepAfterItsLatencyByAnExponential) {
  Accommodation eye(kEye);
  eye.setTarget(0.0, 0.5);
  eye.setTarget(1.0, 4.5);
  EXPECT_EQ(eye.target_D(), 4.5);
  EXPECT_EQ(eye.focusAt_D(1.2999), 0.5);
  EXPECT_NEAR(eye.focusAt_D(1.5), 4.5 - 4.0 * std::exp(-1.0), kRounding);
  EXPECT_NEAR(eye.focusAt_D(1.9), 4.5 - 4.0 * std::exp(-3.0), kRounding);
  EXPECT_NEAR(eye.focusAt_D(9.0), 4.5, kRounding);
}

TEST(Accommodation, AnswersEachOfTwoStepsWithinOneLatency) {
  Accommodation eye(kEye);
  eye.setTarget(0.0, 0.0);
  eye.setTarget(1.0, 2.0);
  eye.setTarget(1.1, 1.0);
  const double turn_D = 2.0 - 2.0 * std::exp(-0.5);  // at 1.4 s
  EXPECT_NEAR(eye.focusAt_D(1.4), turn_D, kRounding);
  EXPECT_NEAR(eye.focusAt_D(1.6), 1.0 + (turn_D - 1.0) * std::exp(-1.0), kRounding);
}

TEST(Accommodation, DoesNotDependOnHowOftenItIsAsked) {
  Accommodation often(kEye), once(kEye);
  for (int i = 0; i < 100; ++i) {
    const double time_s = 0.07 * i, target_D = 1.0 + std::sin(0.9 * i);
    for (Accommodation* eye : {&often, &once}) eye->setTarget(time_s, target_D);
    for (int k = 0; k < 7; ++k) often.focusAt_D(time_s + 0.01 * k);
  }
  EXPECT_EQ(often.focusAt_D(7.123), once.focusAt_D(7.123));
}

TEST(Accommodation, EqualsTheTargetIfSwitchedOff) {
  Accommodation eye({.on = false});
  for (int i = 0; i < 5; ++i) {
    eye.setTarget(i, 0.5 * i);
    EXPECT_EQ(eye.focusAt_D(i), 0.5 * i);
  }
}

TEST(ReachableFocus, RunsFromTheFarPointOverTheAmplitude) {
  AccommodationSettings eye{.far_point_D = 2.0};  // -2 D without glasses
  EXPECT_EQ(reachableFocus_D(eye, 0.0), 2.0);
  EXPECT_EQ(reachableFocus_D(eye, 5.0), 5.0);
  eye.age_years = 50.0;  // 3.5 D
  EXPECT_EQ(reachableFocus_D(eye, 9.0), 5.5);
  eye.far_point_D = -4.0;  // long-sighted: this eye cannot even focus at infinity
  EXPECT_EQ(reachableFocus_D(eye, 0.0), -0.5);
}

TEST(Accommodation, OfAShortSightedEyeRestsAtItsFarPoint) {
  Accommodation eye({.resting_D = 1.0, .far_point_D = 2.0});
  EXPECT_EQ(eye.focusAt_D(0.0), 2.0);
  for (int i = 1; i < 5; ++i) {
    eye.setTarget(i, 0.4 * i);  // to 1.6 D: nothing beyond half a metre
    EXPECT_EQ(eye.focusAt_D(i), 2.0);
  }
}

TEST(Accommodation, JumpsWhenGlassesComeOffAndThenAnswers) {
  Accommodation eye(kEye);
  eye.setTarget(0.0, 3.0);
  EXPECT_EQ(eye.focusAt_D(1.0), 3.0);
  eye.setFarPoint(2.0);  // glasses off; the lens in the eye still accommodates by 3 D
  EXPECT_EQ(eye.focusAt_D(1.1), 5.0);
  EXPECT_NEAR(eye.focusAt_D(1.5), 3.0 + 2.0 * std::exp(-1.0), kRounding);
  EXPECT_NEAR(eye.focusAt_D(9.0), 3.0, 1e-9);
  eye.setFarPoint(2.0);
  EXPECT_NEAR(eye.focusAt_D(9.1), 3.0, 1e-9);
}

}  // namespace FOCI_FILE
}  // namespace foci
