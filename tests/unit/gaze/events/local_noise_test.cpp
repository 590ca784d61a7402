// The offline detector measures noise around each sample, not over the whole recording.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "gaze/events/event_labels.h"
#include "gaze/events/gaze_events.h"
#include "gaze/live/simulator.h"

namespace foci {
namespace FOCI_FILE {

const Screen kScreen{.size_px = {1920, 1080}, .size_m = {0.52, 0.2925}, .distance_m = 0.6};

/// Saccades of half a degree, a second apart.
SimulatedGaze smallSteps() {
  std::vector<GazeTarget> targets;
  for (int i = 0; i < 20; ++i) targets.push_back({{960 + (i % 2) * 20, 540}, 1.0});
  return simulateGaze(targets, kScreen, 500.0, 3, {.noise_deg = 0.01, .blink_rate_Hz = 0.0});
}

/// Share of the simulated saccades before `until_s` that the detector finds.
double foundBefore(const SimulatedGaze& gaze, double until_s) {
  const auto states = labelEvents(gaze.trace, kScreen).states;
  double found = 0.0, all = 0.0;
  for (std::size_t i = 1; i < states.size() && gaze.trace.samples[i].time_s < until_s; ++i) {
    const bool begins =
        gaze.states[i] == GazeState::saccade && gaze.states[i - 1] != GazeState::saccade;
    if (!begins) continue;
    constexpr std::size_t kNear = 15;  // samples, 30 ms
    all += 1.0;
    found +=
        std::find(states.begin() + static_cast<std::ptrdiff_t>(i),
                  states.begin() + static_cast<std::ptrdiff_t>(i + kNear),
                  GazeState::saccade) != states.begin() + static_cast<std::ptrdiff_t>(i + kNear);
  }
  return found / all;
}

TEST(LabelSamples, ANoisyPartDoesNotHideTheSaccadesOfAQuietOne) {
  SimulatedGaze gaze = smallSteps();
  constexpr double kQuiet_s = 6.0;  // of 20 s, so the noisy part would set the median noise
  EXPECT_GE(foundBefore(gaze, kQuiet_s), 0.8);
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise_px(0.0, 30.0);
  for (GazeSample& sample : gaze.trace.samples) {
    if (sample.time_s > kQuiet_s + 2.0 && sample.point_px) {
      *sample.point_px += glm::dvec2(noise_px(random), noise_px(random));
    }
  }
  EXPECT_GE(foundBefore(gaze, kQuiet_s), 0.8);
}

TEST(LabelSamples, TheEndsOfBlocksLeaveNoMark) {
  // A saccade of 60 ms across the border of each second is one event.
  GazeTrace trace;
  trace.rate_Hz = 500.0;
  for (int i = 0; i < 4800; ++i) {
    const double phase_s = i / 500.0 - std::floor(i / 500.0 + 0.5);  // from the nearest second
    const int second = static_cast<int>(std::floor(i / 500.0 + 0.5));
    const double share = std::clamp(phase_s / 0.06 + 0.5, 0.0, 1.0);
    const double moved = second == 0 ? 0.0 : 400.0 * (share * share * (3.0 - 2.0 * share));
    const double x = second % 2 == 1 ? 700.0 + moved : 1100.0 - moved;
    trace.samples.push_back(
        {.time_s = i / 500.0, .point_px = glm::dvec2(second == 0 ? 700.0 : x, 540.0)});
  }
  const auto events = detectEvents(trace, kScreen);
  const auto saccades = std::count_if(events.begin(), events.end(), [](const GazeEvent& event) {
    return event.kind == GazeState::saccade;
  });
  EXPECT_EQ(saccades, 9);
}

}  // namespace FOCI_FILE
}  // namespace foci
