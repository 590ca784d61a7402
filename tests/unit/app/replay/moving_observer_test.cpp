#include <gtest/gtest.h>

#include <random>

#include "app/replay/gaze_in_scene.h"

namespace foci {
namespace FOCI_FILE {

/// Two seconds at 90 Hz: an eye that walks aside looks at a point that moves, with noise.
/// @param eye_m_s, point_m_s  speed of both along x
std::vector<SightSample> watching(double eye_m_s, double point_m_s) {
  constexpr double kNoise_rad = 0.001;
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, kNoise_rad);
  std::vector<SightSample> samples;
  for (int i = 0; i < 180; ++i) {
    const double time_s = i / 90.0;
    SightSample sample{.time_s = time_s, .lasts_s = 1.0 / 90.0, .state = GazeState::pursuit};
    sample.valid = true;
    sample.origin_m = glm::dvec3(eye_m_s * time_s, 1.6, 0.0);
    const glm::dvec3 point_m(0.1 + point_m_s * time_s, 1.5, -0.7);
    const double x = noise(random), y = noise(random);
    sample.direction =
        glm::normalize(glm::normalize(point_m - sample.origin_m) + glm::dvec3(x, y, 0.0));
    const double distance_m = -0.7 / sample.direction.z;
    sample.hit = SightHit{.point_m = sample.origin_m + distance_m * sample.direction,
                          .distance_m = distance_m};
    samples.push_back(sample);
  }
  return samples;
}

GazeState stateOf(std::vector<SightSample> samples) {
  std::vector<GazeEvent> events{{.kind = GazeState::pursuit, .onset_s = 0.0, .duration_s = 2.0}};
  fixateRestingPoints(events, samples, {});
  EXPECT_EQ(samples[90].state, events[0].kind);
  return events[0].kind;
}

TEST(MovingObserver, KeepsAPointInViewByAFixation) {
  EXPECT_EQ(stateOf(watching(0.1, 0.0)), GazeState::fixation);
  EXPECT_EQ(stateOf(watching(-1.0, 0.0)), GazeState::fixation);
}

TEST(MovingObserver, FollowsWhatMovesByPursuit) {
  EXPECT_EQ(stateOf(watching(0.1, 0.2)), GazeState::pursuit);
  EXPECT_EQ(stateOf(watching(0.1, 0.1)), GazeState::pursuit);
}

TEST(MovingObserver, AnEyeThatRestsChangesNothing) {
  EXPECT_EQ(stateOf(watching(0.0, 0.0)), GazeState::pursuit);
}

TEST(MovingObserver, WithoutASurfaceThereIsNoPointToRestOn) {
  std::vector<SightSample> samples = watching(0.1, 0.0);
  for (SightSample& sample : samples) sample.hit.reset();
  EXPECT_EQ(stateOf(samples), GazeState::pursuit);
}

}  // namespace FOCI_FILE
}  // namespace foci
