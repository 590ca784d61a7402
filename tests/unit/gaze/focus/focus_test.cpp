// Tests of vergence, of its combination with the surface, of the limit by age, and of the pupil.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "gaze/focus/accommodation.h"
#include "gaze/focus/pupil.h"
#include "gaze/focus/vergence.h"
#include "gaze/follow/gaze_follower.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kRounding = 1e-9;
constexpr double kIpd_m = 0.063;
const Screen kScreen{.size_px = {1000, 500}, .size_m = {0.5, 0.25}, .distance_m = 0.6};

EyeRay rayTo(const glm::dvec3& origin_m, const glm::dvec3& target_m) {
  return {.origin_m = origin_m, .direction = glm::normalize(target_m - origin_m)};
}

TEST(VergenceOf, IsTheReciprocalOfTheDistanceStraightAhead) {
  const glm::dvec3 left(-0.5 * kIpd_m, 0, 0), right(0.5 * kIpd_m, 0, 0);
  for (const double distance_m : {0.1, 0.33, 1.0, 6.0, 1e6}) {
    const glm::dvec3 target(0, 0, -distance_m);
    const auto vergence = vergenceOf(rayTo(left, target), rayTo(right, target), 0.5);
    EXPECT_NEAR(vergence->value_D, 1.0 / distance_m, kRounding);
    EXPECT_NEAR(vergence->error_D, 0.196, 0.001);
  }
  EXPECT_NEAR(vergenceOf({left, {0, 0, -1}}, {right, {0, 0, -1}}, 0.5)->value_D, 0.0, kRounding);
  // Diverging lines of sight give a negative, finite vergence.
  EXPECT_LT(vergenceOf({left, glm::normalize(glm::dvec3(-0.02, 0, -1))},
                       {right, glm::normalize(glm::dvec3(0.02, 0, -1))}, 0.5)
                ->value_D,
            -0.5);
}

TEST(VergenceOf, HoldsAsideAndIgnoresVerticalError) {
  const glm::dvec3 left(-0.5 * kIpd_m, 0, 0), right(0.5 * kIpd_m, 0, 0);
  const glm::dvec3 target(0.3, 0.2, -0.8);
  const auto vergence = vergenceOf(rayTo(left, target), rayTo(right, target), 0.5);
  constexpr double kBaseOblique = 0.01;  // the eyes are not at the same depth along the gaze
  EXPECT_NEAR(vergence->value_D, 1.0 / glm::length(target), kBaseOblique);
  const glm::dvec3 ahead(0, 0, -0.5);
  const auto tilted = vergenceOf(rayTo(left, ahead + glm::dvec3(0, 0.01, 0)),
                                 rayTo(right, ahead - glm::dvec3(0, 0.01, 0)), 0.5);
  EXPECT_NEAR(tilted->value_D, 2.0, 0.01);
}

TEST(VergenceOf, ErrorIsTheScatterOfNoisyDirections) {
  std::mt19937_64 bits(1);
  std::normal_distribution<double> normal(0.0, std::tan(glm::radians(0.5)));
  const glm::dvec3 left(-0.5 * kIpd_m, 0, 0), right(0.5 * kIpd_m, 0, 0);
  double squares = 0.0, error_D = 0.0;
  constexpr int kTrials = 4000;
  for (int i = 0; i < kTrials; ++i) {
    const glm::dvec3 target(0, 0, -0.7);
    EyeRay a = rayTo(left, target), b = rayTo(right, target);
    a.direction = glm::normalize(a.direction + glm::dvec3{normal(bits), normal(bits), 0});
    b.direction = glm::normalize(b.direction + glm::dvec3{normal(bits), normal(bits), 0});
    const auto vergence = vergenceOf(a, b, 0.5);
    squares += std::pow(vergence->value_D - 1.0 / 0.7, 2);
    error_D = vergence->error_D;
  }
  constexpr double kStatistical = 0.05;
  EXPECT_NEAR(std::sqrt(squares / kTrials) / error_D, 1.0, kStatistical);
}

TEST(VergenceOf, IsAbsentWithoutABaseline) {
  EXPECT_FALSE(vergenceOf({}, {}, 0.5));
  EXPECT_FALSE(vergenceOf({{-0.03, 0, 0}, {-1, 0, 0}}, {{0.03, 0, 0}, {1, 0, 0}}, 0.5));
}

TEST(Combined, WeightsByTheVariances) {
  const std::array<DioptreEstimate, 2> estimates = {{{1.0, 0.1}, {2.0, 0.2}}};
  EXPECT_NEAR(combined(estimates).value_D, 1.2, kRounding);
  EXPECT_NEAR(combined(estimates).error_D, 0.1 / std::sqrt(1.25), kRounding);
  EXPECT_NEAR(combined(std::span(estimates).first(1)).error_D, 0.1, kRounding);
}

TEST(GazeFollower, VergenceCountsOnlyWhereAskedFor) {
  for (const bool on : {false, true}) {
    const auto surface = [](double, const glm::dvec3&, double) { return std::optional(0.5); };
    FollowSettings settings{.vergence = on, .eye_error_deg = 0.5, .surface_error_D = 0.196};
    settings.accommodation.on = false;
    GazeFollower follower(kScreen, 100, surface, settings);
    for (int i = 0; i < 50; ++i) {
      GazeSample sample{.time_s = 0.01 * i, .point_px = glm::dvec2(500, 250)};
      // The eyes look straight ahead, at infinity: 63 mm apart on the screen.
      sample.eyes[0].point_px = glm::dvec2(500 - 63, 250);
      sample.eyes[1].point_px = glm::dvec2(500 + 63, 250);
      follower.push(sample);
    }
    const EyeNow eye = follower.at(0.49);
    EXPECT_EQ(eye.vergence.has_value(), on);
    EXPECT_NEAR(*eye.target_D, on ? 1.0 : 2.0, 0.01);
  }
}

TEST(Accommodation, IsLimitedByAge) {
  EXPECT_DOUBLE_EQ(accommodationAmplitude_D(20), 12.5);
  EXPECT_NEAR(accommodationAmplitude_D(60), 0.5, kRounding);
  EXPECT_EQ(accommodationAmplitude_D(80), 0.0);
  Accommodation old({.latency_s = 0.0, .age_years = 55.0});
  old.setTarget(0.0, 0.5);
  old.setTarget(1.0, 4.0);
  EXPECT_NEAR(old.focusAt_D(20.0), 2.0, kRounding);
  EXPECT_EQ(old.target_D(), 4.0);
}

TEST(Accommodation, LagsBehindNearTargetsAsMeasured) {
  for (const auto& [demand_D, lag_D] :
       {std::pair{0.0, 0.0}, {1.5, 0.175}, {3.0, 0.35}, {4.0, 0.48}, {5.0, 0.60}, {6.0, 0.72}}) {
    EXPECT_NEAR(accommodationLag_D(demand_D), lag_D, kRounding);
    EXPECT_NEAR(reachableFocus_D({.lag = true}, demand_D), demand_D - lag_D, kRounding);
    EXPECT_EQ(reachableFocus_D({}, demand_D), demand_D);
  }
  // A short-sighted eye accommodates less for the same target; at rest no eye lags.
  EXPECT_NEAR(reachableFocus_D({.far_point_D = 2.0, .lag = true}, 5.0), 4.65, kRounding);
  EXPECT_EQ(restingFocus_D({.resting_D = 1.0, .lag = true}), 1.0);
}

TEST(Accommodation, HasATimeConstantEachWay) {
  Accommodation eye({.latency_s = 0.0, .time_constant_s = 0.1, .far_time_constant_s = 0.4});
  eye.setTarget(0.0, 1.0);
  eye.setTarget(1.0, 3.0);
  EXPECT_NEAR(eye.focusAt_D(1.1), 3.0 - 2.0 * std::exp(-1.0), kRounding);
  EXPECT_NEAR(eye.focusAt_D(10.0), 3.0, kRounding);
  eye.setTarget(10.0, 1.0);
  EXPECT_NEAR(eye.focusAt_D(10.4), 1.0 + 2.0 * std::exp(-1.0), 1e-6);
}

TEST(PupilDiameter, FollowsTheUnifiedFormula) {
  const double luminances[] = {1, 10, 100, 1000};
  const double wide[] = {5.1195, 3.8282, 2.8869, 2.3831};
  const double narrow[] = {7.2872, 6.7747, 5.8226, 4.5278};
  constexpr double kDigits = 5e-5;  // rounding of the expected values
  for (int i = 0; i < 4; ++i) {
    const double area_deg2 = std::numbers::pi * 30.0 * 30.0;
    EXPECT_NEAR(pupilDiameter_mm({.luminance_cd_m2 = luminances[i], .area_deg2 = area_deg2}),
                wide[i], kDigits);
    EXPECT_NEAR(pupilDiameter_mm({.luminance_cd_m2 = luminances[i],
                                  .area_deg2 = std::numbers::pi * 5.0 * 5.0,
                                  .both_eyes = false}),
                narrow[i], kDigits);
  }
  EXPECT_GT(pupilDiameter_mm({.luminance_cd_m2 = 0.0, .area_deg2 = 1.0}), 7.5);
}

TEST(FieldArea, IsTheSolidAngle) {
  // The face of a cube, seen from its centre, is a sixth of the sphere.
  constexpr double kSphere_deg2 = 41252.96125;
  EXPECT_NEAR(fieldArea_deg2({.size_px = {1, 1}, .size_m = {2.0, 2.0}, .distance_m = 1.0}),
              kSphere_deg2 / 6.0, 1e-4);
  // The solid angle of a small screen is its width times its height.
  EXPECT_NEAR(fieldArea_deg2({.size_px = {1, 1}, .size_m = {0.02, 0.01}, .distance_m = 1.0}),
              0.02 * 0.01 * 57.29578 * 57.29578, 1e-4);
}

TEST(PupilReflex, StartsAtTheTargetAndConstrictsFasterThanItDilates) {
  PupilReflex reflex;
  EXPECT_EQ(reflex.follow(1.0, 6.0), 6.0);
  const double narrowed = reflex.follow(1.4, 3.0);
  EXPECT_NEAR(narrowed, 3.0 + 3.0 * std::exp(-1.0), 1e-12);
  // Many small steps give the same as one large step.
  PupilReflex steps;
  steps.follow(1.0, 6.0);
  for (int i = 1; i <= 8; ++i) steps.follow(1.0 + 0.05 * i, 3.0);
  EXPECT_NEAR(steps.follow(1.4, 3.0), narrowed, 1e-12);
  EXPECT_LT(reflex.follow(1.8, 6.0), 6.0 - (narrowed - 3.0));
}

}  // namespace FOCI_FILE
}  // namespace foci
