// Saccades in the samples of slow trackers, which see a few samples of each.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "gaze/events/gaze_events.h"
#include "gaze/geometry/line_of_sight.h"

namespace foci {
namespace FOCI_FILE {

const Screen kScreen{.size_px = {1920, 1080}, .size_m = {0.5313, 0.2989}, .distance_m = 0.6};
const glm::dvec2 kLeft_px(440.0, 540.0), kRight_px(1480.0, 540.0);
constexpr int kSaccades = 19;

/// A saccade of minimum jerk each half second, of 50 ms, without oscillation. Noise of 0.7 px.
GazeTrace jumps(double rate_Hz) {
  GazeTrace trace;
  trace.rate_Hz = rate_Hz;
  std::mt19937 random(1);
  std::normal_distribution<double> noise_px(0.0, 0.7);
  for (int i = 0; i < (0.5 * (kSaccades + 1) - 0.1) * rate_Hz; ++i) {
    const double time_s = i / rate_Hz, since_s = std::fmod(time_s + 0.03, 0.5);
    const bool to_right = static_cast<int>((time_s + 0.03) / 0.5) % 2 == 1;
    const double t = time_s < 0.4 ? 1.0 : std::min(since_s / 0.05, 1.0);
    const double way = t * t * t * (10.0 + t * (6.0 * t - 15.0));
    const glm::dvec2 from_px = to_right ? kLeft_px : kRight_px;
    const glm::dvec2 to_px = to_right ? kRight_px : kLeft_px;
    const double x = noise_px(random), y = noise_px(random);
    trace.samples.push_back(
        {.time_s = time_s, .point_px = from_px + way * (to_px - from_px) + glm::dvec2(x, y)});
  }
  return trace;
}

class SlowTracker : public testing::TestWithParam<double> {};

TEST_P(SlowTracker, SaccadesHaveTheirAmplitudeAndNoOscillation) {
  const double amplitude_deg = angleBetween_deg(kScreen, kLeft_px, kRight_px);
  int saccades = 0;
  for (const GazeEvent& event : detectEvents(jumps(GetParam()), kScreen)) {
    EXPECT_NE(event.kind, GazeState::oscillation) << event.onset_s;
    if (event.kind != GazeState::saccade) continue;
    ++saccades;
    EXPECT_NEAR(*event.amplitude_deg, amplitude_deg, 0.03 * amplitude_deg) << event.onset_s;
  }
  EXPECT_EQ(saccades, kSaccades);
}

INSTANTIATE_TEST_SUITE_P(Rates, SlowTracker, testing::Values(50.0, 60.0, 72.0, 90.0));

}  // namespace FOCI_FILE
}  // namespace foci
