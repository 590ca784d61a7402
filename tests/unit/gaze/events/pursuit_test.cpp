#include "gaze/events/pursuit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace foci {
namespace FOCI_FILE {

/// Gaze that moves to the side for 0.3 s at 250 Hz, with white noise along each axis.
StableGaze drift(double from_s, double speed_deg_s, double noise_deg = 0.0, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, std::max(noise_deg, 1e-9));
  StableGaze gaze;
  for (int i = 0; i < 75; ++i) {
    const double time_s = 0.004 * i;
    const double x = glm::radians(speed_deg_s * time_s + noise(random));
    const double y = glm::radians(noise(random));
    gaze.add(from_s + time_s, glm::normalize(glm::dvec3(x, y, -1.0)));
  }
  return gaze;
}

TEST(StableGaze, PursuitGoesOnAcrossASaccade) {
  // 0.9 deg in 0.3 s have a sum of -0.57. Each neighbour in the same direction adds 0.75.
  const StableGaze before = drift(0.0, 3.0), gaze = drift(0.35, 3.0), after = drift(0.7, 3.0);
  EXPECT_FALSE(gaze.isPursuit(0.01, {}));
  EXPECT_TRUE(gaze.isPursuit(0.01, {}, &before, nullptr));
  EXPECT_TRUE(gaze.isPursuit(0.01, {}, &before, &after));
  const StableGaze back = drift(0.7, -3.0), still = drift(0.7, 0.0);
  EXPECT_FALSE(gaze.isPursuit(0.01, {}, &before, &back));
  EXPECT_TRUE(gaze.isPursuit(0.01, {}, &before, &still));
  EXPECT_FALSE(gaze.isPursuit(0.01, {}, &back, &still));
}

TEST(StableGaze, NoiseIsNoPursuitAndHidesNoFastPursuit) {
  constexpr double kNoise_deg = 0.5;
  int pursuits = 0;
  for (unsigned seed = 1; seed <= 100; ++seed) {
    pursuits += drift(0.0, 0.0, kNoise_deg, seed).isPursuit(kNoise_deg, {});
    EXPECT_TRUE(drift(0.0, 20.0, kNoise_deg, seed).isPursuit(kNoise_deg, {})) << seed;
  }
  EXPECT_LE(pursuits, 10);  // of 100; the distance alone passes in 5
}

}  // namespace FOCI_FILE
}  // namespace foci
