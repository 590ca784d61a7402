#include "gaze/focus/accommodation.h"

#include <gtest/gtest.h>

#include <cmath>

namespace foci {
namespace {

constexpr double kRounding = 1e-12;  // a few double operations and one exponential, in dioptres

const AccommodationSettings kEye{.latency_s = 0.3, .time_constant_s = 0.2};

TEST(Accommodation, RestsUntilTheFirstTargetAndTakesThatAtOnce) {
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

TEST(Accommodation, SwitchedOffIsTheTargetItself) {
  Accommodation eye({.on = false});
  for (int i = 0; i < 5; ++i) {
    eye.setTarget(i, 0.5 * i);
    EXPECT_EQ(eye.focusAt_D(i), 0.5 * i);
  }
}

}  // namespace
}  // namespace foci
