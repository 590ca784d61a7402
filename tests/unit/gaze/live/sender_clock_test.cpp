// A simulated sender: each sample has a true time of capture, on our clock, and foci sees the
// sender's time and the arrival alone. The true times are the reference.
#include "gaze/live/sender_clock.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

namespace foci {
namespace FOCI_FILE {

constexpr double kMaxLag_s = 0.002;       // mean that foci may add
constexpr double kLostPerStep_s = 0.5;    // gaze, at most
constexpr double kSilence_s = 0.075;      // and 1.5 samples: gaze is then lost (GazeFollower)
constexpr double kFrame_s = 1.0 / 120.0;  // between two looks at the gaze
constexpr double kDatagram_s = 0.02;      // of samples at most, but always one
constexpr double kTicks_s = 1e-4;         // between samples of a burst

struct Sender {
  double rate_Hz = 100.0, seconds = 600.0, drift = 0.0, jitter_s = 0.02;
  /// The sender's time of a true time.
  std::function<double(double)> ahead_s = [](double) { return 5000.0; };
  /// Whether the sender sends.
  std::function<bool(double)> sends = [](double) { return true; };
  /// Added to the time of a single sample.
  std::function<double(int)> wild_s = [](int) { return 0.0; };
};

struct Outcome {
  double lost_s = 0.0, mean_lag_s = 0.0, worst_lag_s = 0.0;
  std::size_t given = 0, sent = 0, dropped = 0;
  ClockFacts facts{};
};

/// @param settled_s  from which on the lag counts
Outcome play(const Sender& run, double settled_s = 0.0) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> jitter_s(0.0, run.jitter_s);
  SenderClock clock;
  Outcome outcome;
  std::vector<GazeSample> given;
  std::vector<GazeSample> datagram;
  double arrived_s = 0.0, looked_s = 0.0, lag_sum_s = 0.0, latest_s = -1e9, end_of_last_s = -1.0;
  std::size_t judged = 0;
  const auto per_datagram = static_cast<std::size_t>(std::max(1.0, kDatagram_s * run.rate_Hz));
  for (int i = 0; i < static_cast<int>(run.seconds * run.rate_Hz); ++i) {
    const double true_s = 10.0 + i / run.rate_Hz;
    if (!run.sends(true_s)) continue;
    datagram.push_back({.time_s = (1.0 + run.drift) * true_s + run.ahead_s(true_s) + run.wild_s(i),
                        .point_px = glm::dvec2(true_s, 0.0)});  // the truth travels with it
    if (datagram.size() < per_datagram) continue;
    arrived_s = std::max(arrived_s, true_s + jitter_s(random));
    // Gaze is looked at until this datagram arrives. None is lost while none is sent.
    for (; looked_s < arrived_s; looked_s += kFrame_s) {
      const bool silent = looked_s - latest_s > kSilence_s + 1.5 / run.rate_Hz;
      const bool sending = looked_s - end_of_last_s < kSilence_s;
      if (latest_s > 0.0 && silent && sending) outcome.lost_s += kFrame_s;
    }
    given.clear();
    clock.take(datagram, arrived_s, given);
    for (const GazeSample& each : given) {
      EXPECT_LE(each.time_s, arrived_s + kTicks_s);
      EXPECT_GT(each.time_s, latest_s);
      latest_s = each.time_s;
      if (each.point_px->x < settled_s) continue;
      const double lag_s = std::abs(each.time_s - each.point_px->x);
      lag_sum_s += lag_s;
      outcome.worst_lag_s = std::max(outcome.worst_lag_s, lag_s);
      ++judged;
    }
    outcome.given += given.size();
    outcome.sent += datagram.size();
    datagram.clear();
    end_of_last_s = arrived_s;
  }
  outcome.mean_lag_s = lag_sum_s / static_cast<double>(std::max<std::size_t>(judged, 1));
  outcome.dropped = clock.dropped();
  outcome.facts = clock.facts();
  return outcome;
}

void expectFollowed(const Outcome& outcome, int steps, const std::string& what) {
  testing::Test::RecordProperty("mean_lag_us", static_cast<int>(1e6 * outcome.mean_lag_s));
  EXPECT_LE(outcome.lost_s, kLostPerStep_s * steps) << what;
  EXPECT_LT(outcome.mean_lag_s, kMaxLag_s) << what;
  EXPECT_EQ(outcome.facts.steps, static_cast<std::size_t>(steps)) << what;
}

TEST(SenderClock, FollowsADrift) {
  for (const double drift : {-5e-3, -2e-3, -1e-4, 0.0, 1e-4, 2e-3, 5e-3}) {
    for (const double rate_Hz : {30.0, 120.0, 1000.0}) {
      const Sender run{
          .rate_Hz = rate_Hz, .seconds = rate_Hz > 500.0 ? 60.0 : 600.0, .drift = drift};
      const Outcome outcome = play(run);
      expectFollowed(outcome, 0, std::to_string(drift) + " at " + std::to_string(rate_Hz));
      EXPECT_EQ(outcome.given, outcome.sent);
      EXPECT_NEAR(outcome.facts.drift_ppm, 1e6 * drift, 100.0);
    }
  }
}

TEST(SenderClock, FollowsADriftForAnHour) {
  for (const double drift : {-1e-4, 1e-4}) {
    const Outcome outcome = play({.rate_Hz = 60.0, .seconds = 3600.0, .drift = drift});
    expectFollowed(outcome, 0, std::to_string(drift));
    EXPECT_EQ(outcome.given, outcome.sent);
    EXPECT_NEAR(outcome.facts.drift_ppm, 1e6 * drift, 1.0);  // of 20 ms in an hour: 6
  }
}

TEST(SenderClock, FollowsStepsAndLosesNoSample) {
  for (const double step_s : {-1000.0, -60.0, -2.0, -0.5, 0.5, 2.0, 60.0, 1000.0}) {
    for (const double drift : {-5e-3, 0.0, 5e-3}) {
      for (const double rate_Hz : {10.0, 60.0, 500.0}) {
        const Sender run{
            .rate_Hz = rate_Hz, .seconds = 40.0, .drift = drift, .ahead_s = [=](double true_s) {
              return true_s < 30.0 ? 50.0 : 50.0 + step_s;
            }};
        const Outcome outcome = play(run);
        const std::string what = std::to_string(step_s) + " s, drift " + std::to_string(drift) +
                                 " at " + std::to_string(rate_Hz);
        EXPECT_LE(outcome.lost_s, kLostPerStep_s) << what;
        EXPECT_EQ(outcome.given, outcome.sent) << what;
        ASSERT_EQ(outcome.facts.steps, 1u) << what;
        EXPECT_NEAR(outcome.facts.latest_steps[0].ahead_s, step_s, 0.03) << what;
        EXPECT_NEAR(outcome.facts.latest_steps[0].time_s, 30.0, 1.0) << what;
        if (rate_Hz > 50.0) {
          EXPECT_LT(outcome.mean_lag_s, kMaxLag_s) << what;
        }
      }
    }
  }
}

TEST(SenderClock, FollowsAStepEveryFewSeconds) {
  const Sender run{
      .rate_Hz = 120.0, .seconds = 300.0, .drift = -5e-3, .ahead_s = [](double true_s) {
        return 100.0 * std::sin(1e3 * std::floor(true_s / 10.0));
      }};
  const Outcome outcome = play(run);
  expectFollowed(outcome, 29, "");
  EXPECT_EQ(outcome.given, outcome.sent);
}

TEST(SenderClock, DropsASingleWildTime) {
  for (const double wild_s : {-1e6, -3600.0, -1.0, 1.0, 3600.0, 1e6}) {
    const Sender run{
        .seconds = 60.0, .drift = 1e-3, .wild_s = [=](int i) { return i == 2001 ? wild_s : 0.0; }};
    const Outcome outcome = play(run);
    expectFollowed(outcome, 0, std::to_string(wild_s));
    EXPECT_EQ(outcome.given, outcome.sent - 1);
    EXPECT_EQ(outcome.dropped, 1u);
  }
}

TEST(SenderClock, AWildFirstSampleCostsLittle) {
  for (const double wild_s : {-100.0, 100.0}) {
    const Sender run{.seconds = 60.0, .wild_s = [=](int i) { return i == 0 ? wild_s : 0.0; }};
    const Outcome outcome = play(run, 11.0);
    EXPECT_LE(outcome.lost_s, kLostPerStep_s);
    EXPECT_LT(outcome.mean_lag_s, kMaxLag_s);
    EXPECT_GE(outcome.given, outcome.sent - 1);
  }
}

TEST(SenderClock, GoesOnAfterAPause) {
  for (const double pause_s : {0.5, 1.5, 5.0, 300.0}) {
    for (const double drift : {-5e-3, 1e-4, 5e-3}) {
      const Sender run{.seconds = 60.0 + pause_s, .drift = drift, .sends = [=](double true_s) {
                         return true_s < 40.0 || true_s > 40.0 + pause_s;
                       }};
      const Outcome outcome = play(run);
      expectFollowed(outcome, 0, std::to_string(pause_s) + " s, " + std::to_string(drift));
      EXPECT_EQ(outcome.given, outcome.sent);
    }
  }
}

TEST(SenderClock, TakesANewClockAfterAPauseAtOnce) {
  for (const double step_s : {-900.0, 900.0}) {
    const Sender run{
        .seconds = 60.0,
        .ahead_s = [=](double true_s) { return true_s < 40.0 ? 1000.0 : 1000.0 + step_s; },
        .sends = [](double true_s) { return true_s < 40.0 || true_s > 43.0; }};
    const Outcome outcome = play(run);
    expectFollowed(outcome, 1, "");
    EXPECT_EQ(outcome.given, outcome.sent);
  }
}

// A slow computer, or a network that stalls, delivers many samples late and at once.
TEST(SenderClock, LateSamplesKeepTheirTimes) {
  SenderClock clock;
  std::vector<GazeSample> given;
  for (int i = 0; i < 1000; ++i) clock.take({{.time_s = 0.01 * i}}, 5.0 + 0.01 * i, given);
  std::vector<GazeSample> batch;
  for (int i = 1000; i < 1100; ++i) batch.push_back({.time_s = 0.01 * i});
  given.clear();
  clock.take(batch, 5.0 + 10.99, given);
  ASSERT_EQ(given.size(), 100u);
  for (int i = 0; i < 100; ++i) {
    EXPECT_NEAR(given[static_cast<std::size_t>(i)].time_s, 15.0 + 0.01 * i, 1e-6);
  }
  EXPECT_EQ(clock.facts().steps, 0u);
}

TEST(SenderClock, DropsRepeatedTimesAndTimesThatAreNoClock) {
  SenderClock stuck, milliseconds;
  std::vector<GazeSample> of_stuck, of_milliseconds;
  for (int i = 0; i < 1000; ++i) {
    stuck.take({{.time_s = 7.0}}, 0.01 * i, of_stuck);
    milliseconds.take({{.time_s = 10.0 * i}}, 0.01 * i, of_milliseconds);
  }
  EXPECT_EQ(of_stuck.size(), 1u);
  EXPECT_GE(stuck.dropped(), 990u);
  EXPECT_LE(of_milliseconds.size(), 60u);  // of the first half second
  EXPECT_GE(milliseconds.dropped(), 900u);
}

TEST(SenderClock, BelievesAMeasuredClockWhileItsDelaysArePlausible) {
  const auto givenAt = [](double ahead_s) {
    SenderClock clock(true);
    std::vector<GazeSample> given;
    for (int i = 0; i < 200; ++i) {
      const double true_s = 10.0 + 0.01 * i;
      clock.take({{.time_s = true_s + ahead_s}}, true_s + 0.004, given);
    }
    return std::pair(given, clock.facts());
  };
  const auto [right, right_facts] = givenAt(0.0);
  ASSERT_EQ(right.size(), 200u);
  EXPECT_EQ(right.front().time_s, 10.0);  // without the delay
  EXPECT_EQ(right.back().time_s, 11.99);
  EXPECT_TRUE(right_facts.measured);
  for (const double ahead_s : {3600.0, 0.2, -0.2, -3600.0}) {  // the sender's own clock after all
    const auto [wrong, wrong_facts] = givenAt(ahead_s);
    EXPECT_EQ(wrong.size(), 200u);
    EXPECT_NEAR(wrong.back().time_s, 11.994, 1e-9);
    EXPECT_FALSE(wrong_facts.measured);
    EXPECT_EQ(wrong_facts.steps, 0u);
    EXPECT_NEAR(wrong_facts.offset_s, 0.004 - ahead_s, 1e-6);
  }
}

TEST(ClockText, StatesOffsetDriftAndSteps) {
  EXPECT_EQ(clockText({.offset_s = -12.3456, .drift_ppm = 98.4, .steps = 1}),
            "offset -12.346 s, drift 98 ppm, 1 step");
  EXPECT_EQ(clockText({.offset_s = 1.0, .measured = true}), "offset 1.000 s, measured");
}

}  // namespace FOCI_FILE
}  // namespace foci
