#include "gaze/live/trace_player.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace foci {
namespace FOCI_FILE {

constexpr double kRounding = 1e-9;

/// 10 s at 100 Hz, from 50 s on. The pixel is the number of the sample.
GazeTrace tenSeconds() {
  GazeTrace trace{{.format = "TSV"}, 100.0};
  for (int i = 0; i <= 1000; ++i) {
    trace.samples.push_back({.time_s = 50.0 + 0.01 * i, .point_px = glm::dvec2(i, 0)});
  }
  return trace;
}

/// A player, and the samples that it has given. The clock that it is polled with is ours.
struct Played {
  TracePlayer player{tenSeconds()};
  std::vector<GazeSample> samples{};
  double now_s = 7.0;

  Played() { wait(0.0); }
  void wait(double seconds) {
    now_s += seconds;
    player.poll(now_s, samples);
  }
  double last() const { return samples.back().point_px->x; }
  double position_s() const { return player.state().recording_s - 50.0; }
};

TEST(TracePlayer, WaitsAtItsFirstSampleUntilItPlays) {
  Played played;
  played.wait(5.0);
  EXPECT_EQ(played.samples.size(), 1u);
  EXPECT_EQ(played.player.time_s(), 0.0);
  played.player.play(true);
  played.wait(0.25);
  EXPECT_EQ(played.last(), 25.0);
  EXPECT_NEAR(played.samples.back().time_s, 0.25, kRounding);
  EXPECT_NEAR(played.player.recordingAt_s(played.player.time_s()), 50.25, kRounding);
}

TEST(TracePlayer, ASecondOfItsClockIsASecondOfTheRecordingAtAnySpeed) {
  for (const double speed : {0.125, 0.5, 1.0, 4.0}) {
    Played played;
    played.player.setSpeed(speed);
    played.player.play(true);
    for (int i = 0; i < 100; ++i) played.wait(0.02);
    EXPECT_NEAR(played.player.time_s(), 2.0 * speed, kRounding) << speed;
    EXPECT_NEAR(played.last(), std::floor(200.0 * speed + kRounding), 1.0) << speed;
    EXPECT_NEAR(played.samples[10].time_s - played.samples[9].time_s, 0.01, kRounding) << speed;
  }
}

TEST(TracePlayer, ItsClockStandsInAPauseAndNeverGoesBack) {
  Played played;
  played.player.play(true);
  played.wait(4.0);
  played.player.play(false);
  played.wait(0.0);
  const double time_s = played.player.time_s();
  const std::size_t count = played.samples.size();
  played.wait(3.0);
  EXPECT_EQ(played.player.time_s(), time_s);
  EXPECT_EQ(played.samples.size(), count);
  for (const double to_s : {51.0, 59.0, 50.0, 50.5, 70.0, 0.0}) {
    played.player.seek(to_s);
    played.wait(1.0);
    EXPECT_NEAR(played.player.state().recording_s, std::clamp(to_s, 50.0, 60.0), kRounding);
    EXPECT_NEAR(played.last(), 100.0 * played.position_s(), kRounding) << to_s;
    EXPECT_LE(played.samples.back().time_s, played.player.time_s());
  }
  EXPECT_TRUE(std::ranges::is_sorted(played.samples, std::ranges::less_equal{},
                                     &GazeSample::time_s));  // none has the time of another
}

TEST(TracePlayer, ASeekGivesTheSecondsBeforeItsTarget) {
  Played played;
  played.player.seek(58.0);
  played.wait(0.0);
  EXPECT_EQ(played.last(), 800.0);
  EXPECT_LT(played.samples[1].point_px->x, 600.0);  // accommodation has come to rest since then
  EXPECT_GT(played.samples[1].point_px->x, 400.0);
  EXPECT_NEAR(played.samples.back().time_s - played.samples[1].time_s,
              0.01 * (800.0 - played.samples[1].point_px->x), kRounding);
  const std::size_t count = played.samples.size();
  played.player.seek(58.02);  // a step forwards needs no run-up
  played.wait(0.0);
  EXPECT_EQ(played.samples.size(), count + 2);
}

TEST(TracePlayer, PausesAtTheEndAndPlaysAgainFromTheBeginning) {
  Played played;
  played.player.seek(59.9);
  played.player.play(true);
  played.wait(0.0);
  played.wait(5.0);
  EXPECT_FALSE(played.player.state().plays);
  EXPECT_EQ(played.last(), 1000.0);
  EXPECT_TRUE(played.player.status().ends_with("10.00 of 10.00 s, ended"));
  played.player.play(true);
  played.wait(0.0);
  played.wait(0.5);
  EXPECT_EQ(played.last(), 50.0);
}

TEST(TracePlayer, LoopsWithoutLosingTime) {
  Played played;
  played.player.setLoops(true);
  played.player.setSpeed(8.0);
  played.player.play(true);
  for (int i = 0; i < 500; ++i) played.wait(0.01);  // 40 s of it
  EXPECT_TRUE(played.player.state().plays);
  EXPECT_EQ(std::ranges::count(played.samples, glm::dvec2(500, 0), &GazeSample::point_px), 4);
  EXPECT_TRUE(
      std::ranges::is_sorted(played.samples, std::ranges::less_equal{}, &GazeSample::time_s));
}

TEST(TracePlayer, SaysWhereItPlaysFromWhenOn) {
  Played played;
  played.player.play(true);
  played.wait(1.0);
  played.player.setSpeed(0.5);
  played.wait(1.0);
  played.player.seek(58.0);
  played.wait(0.0);
  // A frame may still be of the time before.
  EXPECT_NEAR(played.player.recordingAt_s(1.5), 51.5, kRounding);
  EXPECT_NEAR(played.player.recordingAt_s(played.player.time_s()), 58.0, kRounding);
  played.player.play(false);
  const auto points = played.player.takePoints();
  ASSERT_EQ(points.size(), 5u);
  EXPECT_NEAR(points[1].time_s, 1.0, kRounding);
  EXPECT_NEAR(points[1].recording_s, 51.0, kRounding);
  EXPECT_EQ(points[1].speed, 0.5);
  EXPECT_LT(points[2].recording_s, 56.0);  // the run-up
  EXPECT_EQ(points[2].speed, 0.0);
  EXPECT_NEAR(points[3].recording_s, 58.0, kRounding);
  EXPECT_NEAR(points[3].time_s - points[2].time_s, 58.0 - points[2].recording_s, kRounding);
  EXPECT_EQ(points[3].speed, 0.5);
  EXPECT_EQ(points[4].speed, 0.0);
  EXPECT_TRUE(played.player.takePoints().empty());
}

}  // namespace FOCI_FILE
}  // namespace foci
