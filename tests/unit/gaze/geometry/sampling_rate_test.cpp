#include "gaze/geometry/sampling_rate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "gaze/events/event_labels.h"
#include "gaze/events/gaze_events.h"
#include "gaze/events/online_events.h"

namespace foci {
namespace FOCI_FILE {

const Screen kScreen{.size_px = {1920, 1080}, .size_m = {0.531, 0.299}, .distance_m = 0.6};

/// A new point each half second, in blocks of 4 s. Saccades last 40 ms.
GazeTrace blocks(const std::vector<double>& rates_Hz, double pause_s) {
  GazeTrace trace{{.format = "test", .screen = kScreen}, rates_Hz[0]};
  const glm::dvec2 points_px[] = {{500, 300}, {1400, 300}, {1400, 800}, {500, 800}};
  double begin_s = 0.0;
  for (const double rate_Hz : rates_Hz) {
    for (int i = 0; i < static_cast<int>(4.0 * rate_Hz); ++i) {
      const double time_s = i / rate_Hz;
      const auto now = static_cast<std::size_t>(time_s / 0.5);
      const double share =
          now == 0 ? 1.0 : std::min((time_s - 0.5 * static_cast<double>(now)) / 0.04, 1.0);
      const double way = 0.5 - 0.5 * std::cos(std::numbers::pi * share);
      trace.samples.push_back(
          {.time_s = begin_s + time_s,
           .point_px = glm::mix(points_px[(now + 3) % 4], points_px[now % 4], way)});
    }
    begin_s += 4.0 + pause_s;
  }
  return trace;
}

std::size_t count(const std::vector<GazeEvent>& events, GazeState kind, double from_s,
                  double to_s) {
  std::size_t found = 0;
  for (const GazeEvent& event : events) {
    found += event.kind == kind && event.onset_s >= from_s && event.onset_s < to_s;
  }
  return found;
}

TEST(SamplingRate, StretchesBeginWhereTheRateChanges) {
  for (const double pause_s : {0.0, 2.0}) {
    const GazeTrace trace = blocks({1000.0, 250.0, 2000.0, 90.0}, pause_s);
    const auto stretches = rateStretchesOf(trace);
    ASSERT_EQ(stretches.size(), 4u);
    const double rates_Hz[] = {1000.0, 250.0, 2000.0, 90.0};
    std::size_t first = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR(stretches[i].rate_Hz, rates_Hz[i], 0.01 * rates_Hz[i]);
      EXPECT_NEAR(static_cast<double>(stretches[i].first), static_cast<double>(first), 1.0) << i;
      first += static_cast<std::size_t>(4.0 * rates_Hz[i]);
    }
  }
}

TEST(SamplingRate, OneRateIsOneStretchAtTheTracesOwnRate) {
  // Times in whole milliseconds, rows in pairs, and data loss are no change of rate.
  GazeTrace trace{{.format = "test"}, 60.0};
  for (int i = 0; i < 3000; ++i) {
    const bool lost = i % 100 > 90;
    const double jitter_s = i % 2 == 0 ? 0.005 : 0.0;
    if (!lost) trace.samples.push_back({.time_s = std::round(1e3 * i / 60.0) / 1e3 + jitter_s});
  }
  const auto stretches = rateStretchesOf(trace);
  ASSERT_EQ(stretches.size(), 1u);
  EXPECT_EQ(stretches[0].rate_Hz, 60.0);
}

TEST(SamplingRate, EventsOfASlowerBlockAreFound) {
  for (const auto& rates_Hz : {std::vector{1000.0, 250.0}, {2000.0, 500.0}, {90.0, 30.0}}) {
    const GazeTrace trace = blocks(rates_Hz, 1.0);
    const auto events = detectEvents(trace, kScreen);
    for (const double from_s : {0.0, 5.0}) {
      EXPECT_EQ(count(events, GazeState::fixation, from_s, from_s + 4.0), 8u) << rates_Hz[1];
      EXPECT_EQ(count(events, GazeState::saccade, from_s, from_s + 4.0), 7u) << rates_Hz[1];
    }
    const auto online = eventsOf(labelEvents(trace, kScreen, {}, true).states, trace, kScreen);
    EXPECT_EQ(count(online, GazeState::saccade, 5.0, 9.0), 7u) << rates_Hz[1];
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
