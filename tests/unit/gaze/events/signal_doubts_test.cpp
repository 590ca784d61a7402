// Signals that tell nothing are not labelled as gaze.
#include "gaze/events/event_labels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "gaze/events/recording_quality.h"
#include "gaze/events/saccades.h"
#include "gaze/live/simulator.h"

namespace foci {
namespace FOCI_FILE {

const Screen kScreen{.size_px = {1920, 1080}, .size_m = {0.52, 0.2925}, .distance_m = 0.6};

GazeTrace gazeAt(double rate_Hz, double noise_deg = 0.05) {
  std::vector<GazeTarget> targets;
  for (int i = 0; i < 16; ++i) {
    targets.push_back({{960 + 700 * std::sin(2.4 * i), 540 + 400 * std::cos(3.1 * i)}, 0.6});
  }
  GazeTrace trace =
      simulateGaze(targets, kScreen, rate_Hz, 3, {.noise_deg = noise_deg, .blink_rate_Hz = 0.0})
          .trace;
  trace.simulated = false;  // as a file would hold it
  return trace;
}

void expectUnjudged(const GazeTrace& trace, const std::string& reason) {
  for (const Detector detector : {Detector::trained, Detector::ivt, Detector::idt}) {
    for (const bool online : {false, true}) {
      const EventLabels labels = labelEvents(trace, kScreen, {.detector = detector}, online);
      const auto unjudged =
          std::count(labels.states.begin(), labels.states.end(), GazeState::unjudged);
      const double share =
          static_cast<double>(unjudged) / static_cast<double>(labels.states.size());
      EXPECT_GT(share, online ? 0.8 : 0.999) << reason << ' ' << nameOf(detector);
      ASSERT_EQ(labels.warnings.size(), 1u) << reason;
      EXPECT_NE(labels.warnings[0].find(reason), std::string::npos) << labels.warnings[0];
      EXPECT_FALSE(labels.any_judged) << reason;
    }
  }
}

TEST(SignalDoubts, WhatCannotBeJudgedIsNotLabelled) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise_px(0.0, 200.0);  // 5 degrees
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (const double rate_Hz : {60.0, 500.0}) {
    GazeTrace white = gazeAt(rate_Hz), frozen = white, lost = white;
    for (GazeSample& sample : white.samples) {
      sample.point_px = glm::dvec2(960, 540) + glm::dvec2(noise_px(random), noise_px(random));
    }
    for (GazeSample& sample : frozen.samples) sample.point_px = glm::dvec2(800.5, 400.25);
    for (GazeSample& sample : lost.samples) {
      if (share(random) < 0.8) sample.point_px.reset();
    }
    expectUnjudged(white, "white noise");
    expectUnjudged(frozen, "does not change");
    expectUnjudged(lost, "is lost");
  }
  expectUnjudged(gazeAt(20.0), "below 25 Hz");
}

TEST(SignalDoubts, LeaveGoodGazeAlone) {
  for (const double rate_Hz : {30.0, 60.0, 250.0, 1000.0}) {
    for (const double noise_deg : {0.01, 0.5, 1.5}) {
      GazeTrace trace = gazeAt(rate_Hz, noise_deg);
      for (GazeSample& sample : trace.samples) {  // a long loss, labelled as such
        if (sample.time_s > 3.0 && sample.time_s < 5.0) sample.point_px.reset();
      }
      for (const double ahead_s : {0.02, kWholeRecording}) {
        const auto doubts = signalDoubts(trace, kScreen, {}, ahead_s);
        const auto doubted = std::count_if(doubts.begin(), doubts.end(), [](SignalDoubt doubt) {
          return doubt != SignalDoubt::none;
        });
        // Before a loss has lasted for `max_blink_s`, nobody knows that it is long.
        const double most = ahead_s < 1.0 ? 0.06 : 0.0;
        EXPECT_LE(static_cast<double>(doubted), most * static_cast<double>(doubts.size()))
            << rate_Hz << ' ' << noise_deg << ' ' << ahead_s;
      }
    }
  }
}

TEST(SignalDoubts, ShortBurstsBetweenLongLossesAreUnjudged) {
  GazeTrace trace = gazeAt(120.0);
  for (GazeSample& sample : trace.samples) {
    if (std::fmod(sample.time_s, 1.0) > 0.15) sample.point_px.reset();
  }
  const auto states = labelEvents(trace, kScreen).states;
  for (std::size_t i = 60; i + 60 < states.size(); ++i) {
    EXPECT_EQ(states[i], trace.samples[i].point_px ? GazeState::unjudged : GazeState::lost) << i;
  }
}

TEST(SignalDoubts, OnlyTheFrozenStretchIsUnjudged) {
  GazeTrace trace = gazeAt(250.0);
  for (std::size_t i = 500; i < 1000; ++i) trace.samples[i].point_px = trace.samples[500].point_px;
  const auto states = labelEvents(trace, kScreen).states;
  for (std::size_t i = 0; i < states.size(); ++i) {
    EXPECT_EQ(states[i] == GazeState::unjudged, i >= 500 && i < 1000) << i;
  }
}

TEST(LabelByVelocity, CutsAtTheThreshold) {
  std::vector<TimedSight> sights;
  for (int i = 0; i < 100; ++i) {
    const double speed_deg_s = i < 50 ? 29.0 : 31.0, at_s = 0.002 * (i - 50);
    const double angle_rad = glm::radians(speed_deg_s * at_s);
    sights.push_back({0.002 * i, glm::dvec3(std::sin(angle_rad), 0.0, -std::cos(angle_rad))});
  }
  sights[10].direction.reset();
  const auto states = labelByVelocity(sights, 500.0, 30.0);
  EXPECT_EQ(states[10], GazeState::blink);
  EXPECT_EQ(states[30], GazeState::fixation);
  EXPECT_EQ(states[70], GazeState::saccade);
}

TEST(LabelByDispersion, NeedsAWindowOfADegree) {
  std::vector<TimedSight> sights;
  for (int i = 0; i < 300; ++i) {
    // Gaze rests, moves by 2 degrees within 50 ms, and rests again.
    const double x_deg = std::clamp(0.2 * (i - 100), 0.0, 2.0);
    sights.push_back({0.005 * i, glm::dvec3(std::sin(glm::radians(x_deg)), 0.0,
                                            -std::cos(glm::radians(x_deg)))});
  }
  const auto states = labelByDispersion(sights);
  EXPECT_EQ(states[50], GazeState::fixation);
  EXPECT_EQ(states[200], GazeState::fixation);
  // The window's last sample with a dispersion of 1 degree, and the first one after the move.
  EXPECT_EQ(states[105], GazeState::fixation);
  EXPECT_EQ(std::count(states.begin() + 100, states.begin() + 112, GazeState::saccade), 0)
      << "each sample lies within a degree of one of both places";
}

TEST(RecordingQuality, IsThatOfTheSimulatedTracker) {
  GazeTrace trace = gazeAt(500.0, 0.2);
  for (std::size_t i = 1000; i < 1200; ++i) trace.samples[i].point_px.reset();
  const auto labels = labelEvents(trace, kScreen, {.detector = Detector::rules});
  const auto quality =
      qualityOf(trace, kScreen, labels.states, eventsOf(labels, trace, kScreen, {}));
  constexpr double kStatistical = 0.05;
  EXPECT_NEAR(*quality.rms_s2s_deg, 0.4, 0.4 * kStatistical);  // both samples, both axes
  EXPECT_NEAR(*quality.sd_deg, 0.2 * std::sqrt(2.0), 0.1);     // and the drift
  EXPECT_NEAR(quality.lost, 200.0 / static_cast<double>(trace.samples.size()), 1e-12);
  EXPECT_NEAR(quality.longest_gap_s, 0.4, 1e-9);
  EXPECT_LT(quality.jitter_s, 1e-9);
  EXPECT_EQ(quality.unjudged, 0.0);
  ASSERT_TRUE(quality.main_sequence);
  EXPECT_GT(quality.main_sequence->saccades, 10);
}

TEST(RecordingQuality, CountsLossAtBothEndsAsGaps) {
  GazeTrace trace = gazeAt(500.0);
  const auto longest_s = [&] { return qualityOf(trace, kScreen, {}, {}).longest_gap_s; };
  EXPECT_EQ(longest_s(), 0.0);
  for (std::size_t i = 0; i < 100; ++i) trace.samples[i].point_px.reset();
  EXPECT_NEAR(longest_s(), 0.2, 1e-9);
  for (std::size_t i = trace.samples.size() - 150; i < trace.samples.size(); ++i) {
    trace.samples[i].point_px.reset();
  }
  EXPECT_NEAR(longest_s(), 0.3, 1e-9);
}

TEST(RecordingQuality, HasNoStepsAcrossAPause) {
  GazeTrace trace{{.format = "test", .screen = kScreen}, 500.0};
  for (int i = 0; i < 400; ++i) {
    GazeSample sample{.time_s = 0.002 * i + (i < 200 ? 0.0 : 3.0)};
    sample.point_px = glm::dvec2(i < 200 ? 500.0 : 1500.0, 400.0);
    trace.samples.push_back(sample);
  }
  const auto quality = qualityOf(
      trace, kScreen, std::vector<GazeState>(trace.samples.size(), GazeState::fixation), {});
  EXPECT_LT(*quality.rms_s2s_deg, 1e-6);
  EXPECT_LT(*quality.sd_deg, 1e-6);
}

TEST(RangeWarnings, NameWhatTheTrainingDidNotHold) {
  RecordingQuality quality{.rate_Hz = 250.0};
  quality.rms_s2s_deg = 3.6;
  const auto warnings = rangeWarnings(quality, {});
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("noise 1.800 deg, trained up to"), std::string::npos) << warnings[0];
  EXPECT_TRUE(rangeWarnings(quality, {.detector = Detector::rules}).empty());
  quality = {.rate_Hz = 30.0};
  ASSERT_EQ(rangeWarnings(quality, {}).size(), 1u);
  EXPECT_NE(rangeWarnings(quality, {})[0].find("rate 30.000 Hz, trained from"), std::string::npos);
}

}  // namespace FOCI_FILE
}  // namespace foci
