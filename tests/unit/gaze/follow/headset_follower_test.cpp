// A simulated observer in a headset: what the follower makes of both eyes' rays.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "gaze/follow/gaze_follower.h"
#include "gaze/geometry/gaze_sample.h"
#include "gaze/geometry/line_of_sight.h"
#include "gaze/sources/table_layout.h"

namespace foci {
namespace FOCI_FILE {

constexpr double kIpd_m = 0.06, kRate_Hz = 120.0, kGoal_D = 0.1;

/// Both eyes look at a point in the head's frame, each with an error of its own.
GazeSample lookAt(double time_s, const glm::dvec3& target_m, const Screen& screen,
                  std::mt19937& random, double noise_deg) {
  std::normal_distribution<double> noise(0.0, glm::radians(noise_deg));
  GazeSample sample{.time_s = time_s, .head = HeadInWorld{}};
  for (std::size_t side : {0, 1}) {
    EyeSample& eye = sample.eyes[side];
    eye.origin_m = glm::dvec3(side == 0 ? -0.5 * kIpd_m : 0.5 * kIpd_m, 0.0, 0.0);
    glm::dvec3 sight = glm::normalize(target_m - *eye.origin_m);
    if (noise_deg > 0.0) sight += glm::dvec3{noise(random), noise(random), 0.0};
    eye.direction = glm::normalize(sight);
  }
  sample.direction = meanDirection(sample.eyes);
  sample.point_px = pointOnScreen_px(screen, *sample.direction);
  return sample;
}

/// Vergence after 0.6 s on a target whose surface is `surface_m` away.
EyeNow afterFixation(double distance_m, double surface_m, double noise_deg) {
  const Screen screen = headsetScreen({}, 12.0);
  const auto surface = [&](double, const glm::dvec3&, double) { return std::optional(surface_m); };
  GazeFollower follower(screen, kRate_Hz, surface);
  std::mt19937 random(3);
  const glm::dvec3 target_m = distance_m * glm::normalize(glm::dvec3(0.2, -0.1, -1.0));
  double time_s = 0.0;
  for (int i = 0; i < 72; ++i) {
    time_s = i / kRate_Hz;
    follower.push(lookAt(time_s, target_m, screen, random, noise_deg));
  }
  return follower.at(time_s);
}

TEST(VergenceOfAHeadset, IsExactWithoutNoise) {
  for (const double distance_m : {0.3, 0.5, 1.0, 2.0, 10.0}) {
    const EyeNow eye = afterFixation(distance_m, distance_m, 0.0);
    ASSERT_TRUE(eye.vergence) << distance_m;
    // Depth along the mean direction differs from the distance by the eyes' asymmetry.
    EXPECT_NEAR(eye.vergence->value_D, 1.0 / distance_m, 0.02) << distance_m;
    EXPECT_EQ(vergenceDisagrees(eye), false) << distance_m;
  }
}

TEST(VergenceOfAHeadset, IsWithinTheGoalThroughNoise) {
  for (const double distance_m : {0.3, 0.5, 1.0, 2.0}) {
    const EyeNow eye = afterFixation(distance_m, distance_m, 0.25);
    ASSERT_TRUE(eye.vergence) << distance_m;
    EXPECT_NEAR(eye.vergence->value_D, 1.0 / distance_m, kGoal_D) << distance_m;
    // The stated error is that of directions 0.5 degrees wrong, each eye on its own.
    EXPECT_NEAR(eye.vergence->error_D, std::sqrt(2.0) * glm::radians(0.5) / kIpd_m, 0.01);
  }
}

TEST(VergenceOfAHeadset, FlagsASurfaceElsewhere) {
  EXPECT_EQ(vergenceDisagrees(afterFixation(0.5, 0.3, 0.1)), true);
  EXPECT_EQ(vergenceDisagrees(afterFixation(0.4, 5.0, 0.1)), true);
  // Far surfaces are alike to two eyes.
  EXPECT_EQ(vergenceDisagrees(afterFixation(5.0, 10.0, 0.1)), false);
}

TEST(VergenceOfAHeadset, DoesNotMoveTheFocusUnlessAsked) {
  const EyeNow eye = afterFixation(0.4, 2.0, 0.0);
  ASSERT_TRUE(eye.target_D);
  EXPECT_EQ(*eye.target_D, 0.5);
}

}  // namespace FOCI_FILE
}  // namespace foci
