#include "gaze/live/simulator.h"

#include <gtest/gtest.h>

#include "gaze/geometry/line_of_sight.h"

namespace foci {
namespace FOCI_FILE {

const Screen kScreen{.size_px = {1920, 1080}, .size_m = {0.52, 0.2925}, .distance_m = 0.6};
const std::vector<GazeTarget> kTwo{{{400, 540}, 1.0}, {{1500, 540}, 1.0}};
const OculomotorSettings kIdeal{.latency_sd_s = 0.0,
                                .landing_error = 0.0,
                                .drift_deg_s = 0.0,
                                .tremor_deg = 0.0,
                                .noise_deg = 0.0,
                                .blink_rate_Hz = 0.0};

TEST(SimulateGaze, IsTheSameForTheSameSeedOnly) {
  const SimulatedGaze a = simulateGaze(kTwo, kScreen, 250, 1),
                      b = simulateGaze(kTwo, kScreen, 250, 1),
                      c = simulateGaze(kTwo, kScreen, 250, 2);
  ASSERT_EQ(a.trace.samples.size(), 500u);
  EXPECT_EQ(a.states, b.states);
  bool differs = false;
  for (std::size_t i = 0; i < a.trace.samples.size(); ++i) {
    EXPECT_EQ(a.trace.samples[i].point_px, b.trace.samples[i].point_px);
    differs |= a.trace.samples[i].point_px != c.trace.samples[i].point_px;
  }
  EXPECT_TRUE(differs);
  EXPECT_TRUE(a.trace.simulated);
}

TEST(SimulateGaze, IdealObserverRestsThenMovesAlongTheMainSequence) {
  const double rate_Hz = 2000.0;
  const SimulatedGaze gaze = simulateGaze(kTwo, kScreen, rate_Hz, 1, kIdeal);
  const auto& samples = gaze.trace.samples;
  const double amplitude_deg = angleBetween_deg(kScreen, kTwo[0].point_px, kTwo[1].point_px);
  const double duration_s = 0.021 + 0.0022 * amplitude_deg;
  double first_s = -1.0, last_s = 0.0, peak_deg_s = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (i > 0) {
      peak_deg_s = std::max(peak_deg_s, rate_Hz * angleBetween_deg(kScreen, *samples[i].point_px,
                                                                   *samples[i - 1].point_px));
    }
    if (gaze.states[i] != GazeState::saccade) continue;
    if (first_s < 0.0) first_s = samples[i].time_s;
    last_s = samples[i].time_s;
  }
  constexpr double kRounding_px = 1e-9, kTwoSamples_s = 0.001;
  EXPECT_LT(glm::distance(*samples.front().point_px, kTwo[0].point_px), kRounding_px);
  EXPECT_LT(glm::distance(*samples.back().point_px, kTwo[1].point_px), kRounding_px);
  EXPECT_NEAR(first_s, 1.0 + kIdeal.latency_s, kTwoSamples_s);
  EXPECT_NEAR(last_s - first_s, duration_s, kTwoSamples_s);
  EXPECT_NEAR(peak_deg_s, 1.875 * amplitude_deg / duration_s, 0.01 * peak_deg_s);
}

TEST(SimulateGaze, DriftAndNoiseHaveTheirSizes) {
  OculomotorSettings drifting = kIdeal, noisy = kIdeal;
  drifting.drift_deg_s = 0.3;
  noisy.noise_deg = 0.5;
  const std::vector<GazeTarget> one{{{960, 540}, 60.0}};
  const auto slow = simulateGaze(one, kScreen, 100, 9, drifting).trace.samples;
  double speed_deg_s = 0.0;
  for (std::size_t i = 1; i < slow.size(); ++i) {
    speed_deg_s += 100.0 * angleBetween_deg(kScreen, *slow[i].point_px, *slow[i - 1].point_px);
  }
  // 60 s contain about 150 independent drifts. 5 % is more than one standard error of their mean.
  EXPECT_NEAR(speed_deg_s / static_cast<double>(slow.size()), 0.3, 0.05);

  const auto noise = simulateGaze(one, kScreen, 100, 9, noisy).trace.samples;
  double squares_deg2 = 0.0;
  for (const GazeSample& sample : noise) {
    squares_deg2 += std::pow(angleBetween_deg(kScreen, *sample.point_px, {960, 540}), 2);
  }
  EXPECT_NEAR(std::sqrt(squares_deg2 / (2.0 * static_cast<double>(noise.size()))), 0.5, 0.02);
}

TEST(SimulateGaze, BlinksHideTheEyeAsOftenAndAsLongAsSet) {
  OculomotorSettings blinking = kIdeal;
  blinking.blink_rate_Hz = 0.5;
  const SimulatedGaze gaze = simulateGaze({{{960, 540}, 300.0}}, kScreen, 100, 4, blinking);
  int blinks = 0, hidden = 0;
  for (std::size_t i = 0; i < gaze.states.size(); ++i) {
    const bool blink = gaze.states[i] == GazeState::blink;
    EXPECT_EQ(blink, gaze.trace.samples[i].blink);
    EXPECT_EQ(blink, !gaze.trace.samples[i].point_px);
    blinks += blink && gaze.states[i - 1] != GazeState::blink;
    hidden += blink;
  }
  // The mean cycle has 2 s of waiting, 0.5 s of pause and 0.15 s with closed eyes. So there are
  // about 113 blinks, +-20 %.
  EXPECT_NEAR(blinks, 300.0 / 2.65, 22.0);
  EXPECT_NEAR(hidden / 100.0 / blinks, blinking.blink_duration_s, 0.02);
}

}  // namespace FOCI_FILE
}  // namespace foci
