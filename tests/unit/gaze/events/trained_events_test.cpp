#include "gaze/events/trained_events.h"

#include <gtest/gtest.h>

#include <tbb/global_control.h>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "base/input_error.h"
#include "base/text.h"
#include "gaze/events/event_labels.h"
#include "gaze/events/online_events.h"
#include "gaze/events/recording_quality.h"
#include "gaze/geometry/gaze_sample.h"
#include "gaze/geometry/line_of_sight.h"
#include "gaze/live/simulator.h"
#include "gaze/sources/trace_reader.h"
#include "tests/bench/boosting.h"
#include "tests/bench/packed_model.h"
#include "tests/unit/gaze/scratch.h"

namespace foci {
namespace FOCI_FILE {

const Screen kScreen{.size_px = {1920, 1080}, .size_m = {0.52, 0.2925}, .distance_m = 0.6};

std::vector<GazeTarget> walk() {
  std::vector<GazeTarget> targets;
  for (int i = 0; i < 12; ++i) {
    targets.push_back({{960 + 700 * std::sin(2.4 * i), 540 + 400 * std::cos(3.1 * i)}, 0.6});
  }
  return targets;
}

std::vector<SampleLabel> followed(const GazeTrace& trace, std::size_t samples, double delay_s) {
  TrainedEvents events(trace.rate_Hz, {.delay_s = delay_s}, builtinEventModel());
  std::vector<SampleLabel> labels;
  for (std::size_t i = 0; i < samples; ++i) {
    const GazeSample& sample = trace.samples[i];
    const TimedSight sight = sightOf(sample, kScreen);
    if (const auto label = events.push(sample, sight, sight.direction)) labels.push_back(*label);
  }
  return labels;
}

TEST(BoostedTrees, GoToTheRightAboveTheEdgeAndAddUp) {
  BoostedTrees trees{.classes = 2, .features = 1, .depth = 1};
  trees.edges.assign(BoostedTrees::kBins - 1, 0.0F);
  std::iota(trees.edges.begin(), trees.edges.end(), 0.0F);
  trees.priors = {0.5F, 0.5F};
  trees.nodes = {{0, 10}, {0, BoostedTrees::kNoSplit}};
  trees.leaves = {4096, -4096, 0, 0};  // log odds of 1 and -1 for the first class
  const auto firstOf = [&](float value) {
    std::array<double, 2> probabilities{};
    trees.probabilities({&value, 1}, probabilities);
    EXPECT_DOUBLE_EQ(probabilities[0] + probabilities[1], 1.0);
    return probabilities[0];
  };
  EXPECT_DOUBLE_EQ(firstOf(10.0F), 1.0 / (1.0 + std::exp(-1.0)));
  EXPECT_DOUBLE_EQ(firstOf(10.5F), 1.0 / (1.0 + std::exp(1.0)));
}

TEST(Boosting, GivesTheSameTreesWithOneThreadAndTwo) {
  TrainingRows rows{.features = 4};
  std::mt19937_64 random(3);
  std::uniform_real_distribution<float> any(-1.0F, 1.0F);
  for (int i = 0; i < 5000; ++i) {
    const float x = any(random), y = any(random);
    rows.values.insert(rows.values.end(), {x, y, x * y, any(random)});
    rows.classes.push_back(x * x + y > 0.2F ? (y > 0.5F ? 2 : 1) : 0);
    rows.weights.push_back(1.0F);
  }
  BoostedTrees trees[2];
  for (const std::size_t threads : {1, 2}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    trees[threads - 1] = Boosting(rows, 3, {.rounds = 20, .depth = 3}).train();
  }
  EXPECT_EQ(trees[0].leaves, trees[1].leaves);
  EXPECT_EQ(trees[0].edges, trees[1].edges);
  int right = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    std::array<double, 3> p{};
    trees[0].probabilities({&rows.values[4 * i], 4}, p);
    right += std::max_element(p.begin(), p.end()) - p.begin() == rows.classes[i] ? 1 : 0;
  }
  EXPECT_GT(right, 4500);
}

TEST(ViterbiPath, IsTheBestOfAllPathsAtAnyRate) {
  const std::vector<double> evidence = {0.9, 0.8, 0.4, 0.9, 0.2, 0.1, 0.3, 0.45, 0.6, 0.2};
  for (const double step_s : {0.001, 0.01}) {
    const ViterbiPath<2> path(0.5 * step_s);
    std::vector<Evidence<2>> samples;
    for (const double p : evidence) samples.push_back({{p, 1.0 - p}, step_s});
    const auto found = mostLikelyStates(path, samples);
    double best = -INFINITY;
    std::vector<std::size_t> best_path;
    for (unsigned bits = 0; bits < 1U << evidence.size(); ++bits) {
      double score = 0.0;
      std::vector<std::size_t> states;
      for (std::size_t i = 0; i < evidence.size(); ++i) {
        states.push_back(bits >> i & 1U);
        const double p = states[i] == 0 ? evidence[i] : 1.0 - evidence[i];
        score += step_s * std::log(p + 1e-4);
        if (i > 0 && states[i] != states[i - 1]) score -= 0.5 * step_s;
      }
      if (score > best) {
        best = score;
        best_path = states;
      }
    }
    EXPECT_EQ(found, best_path) << step_s;
  }
}

TEST(EventModel, ReadsBackWhatItWrites) {
  const std::string bytes = packedModel(builtinEventModel());
  EXPECT_LT(bytes.size(), 1'000'000u);
  EXPECT_EQ(packedModel(unpackModel(bytes, "model")), bytes);
}

TEST(EventModel, NamesItsSetsAndTheirLicences) {
  for (const ModelSet& set : builtinEventModel().sets) {
    EXPECT_EQ(set.sha256.size(), 64u) << set.name;
    EXPECT_TRUE(set.licence == "GPL-3.0" || set.licence == "MIT") << set.name;
    EXPECT_GT(set.files, 0) << set.name;
  }
  EXPECT_GE(builtinEventModel().sets.size(), 2u);
}

TEST(EventModel, RefusesAnotherVersionAndDamage) {
  const std::string bytes = packedModel(builtinEventModel());
  std::string other = bytes;
  other.replace(other.find("model 2"), 7, "model 1");
  const auto errorOf = [](const std::string& model) -> std::string {
    try {
      unpackModel(model, "my.model");
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_NE(errorOf(other).find("my.model: event model of version 1: expected version 2"),
            std::string::npos)
      << errorOf(other);
  for (const std::size_t length :
       {std::size_t{0}, std::size_t{10}, std::size_t{40}, bytes.size() / 2, bytes.size() - 1}) {
    EXPECT_NE(errorOf(bytes.substr(0, length)), "no error") << length;
  }
  EXPECT_NE(errorOf(bytes + "x"), "no error");
}

// A recording that is cut after any sample has the same labels up to there.
TEST(TrainedEvents, DoNotDependOnLaterSamples) {
  const SimulatedGaze gaze =
      simulateGaze({{{500, 500}, 0.5}, {{1200, 700}, 0.5}, {{700, 300}, 0.5}}, kScreen, 120, 5,
                   {.noise_deg = 0.1, .blink_rate_Hz = 0.5});
  for (const double delay_s : {0.0, 0.02, 0.05, 0.09}) {
    const auto all = followed(gaze.trace, gaze.trace.samples.size(), delay_s);
    for (std::size_t end = 1; end <= gaze.trace.samples.size(); ++end) {
      const auto cut = followed(gaze.trace, end, delay_s);
      ASSERT_LE(cut.size(), all.size());
      for (std::size_t i = 0; i < cut.size(); ++i) {
        ASSERT_EQ(cut[i].state, all[i].state) << delay_s << ", cut after " << end;
        ASSERT_EQ(cut[i].probabilities, all[i].probabilities);
      }
    }
  }
}

TEST(TrainedEvents, LabelEachSampleOnceItsDelayHasPassed) {
  const SimulatedGaze gaze = simulateGaze(walk(), kScreen, 250, 5);
  for (const double delay_s : {0.0, 0.02, 0.1}) {
    const auto labels = followed(gaze.trace, 100, delay_s);
    EXPECT_EQ(labels.size(), 100 - static_cast<std::size_t>(250 * delay_s + 0.5));
    EXPECT_EQ(
        labelTrainedOnline(gaze.trace, kScreen, {.delay_s = delay_s}, builtinEventModel()).size(),
        gaze.trace.samples.size());
  }
}

TEST(LabelEvents, DoNotDependOnTheLengthOfAPause) {
  // The features of the last samples before a pause are asked for after it.
  const GazeTrace walked =
      simulateGaze(walk(), kScreen, 256, 5, {.noise_deg = 0.1}).trace;  // exact times
  const auto labels = [&](double pause_s, bool online) {
    GazeTrace trace = walked;
    for (std::size_t i = trace.samples.size() / 2; i < trace.samples.size(); ++i) {
      trace.samples[i].time_s += pause_s;
    }
    return online ? labelTrainedOnline(trace, kScreen, {}, builtinEventModel())
                  : labelTrained(trace, kScreen, {}, builtinEventModel());
  };
  for (const bool online : {false, true}) {
    const auto shorter = labels(5.0, online), longer = labels(3600.0, online);
    ASSERT_EQ(shorter.size(), longer.size());
    for (std::size_t i = 0; i < shorter.size(); ++i) {
      EXPECT_EQ(shorter[i].state, longer[i].state) << i;
      EXPECT_EQ(shorter[i].probabilities, longer[i].probabilities) << i;
    }
  }
}

// At high rates, offline labels tell stable gaze as online labels do, which no set left out
// contradicts, but for short rests and what lies beside them. Data loss is known as a whole
// offline.
TEST(LabelEvents, TellStableGazeOfFastTrackersAlikeOfflineAndOnline) {
  const GazeTrace trace =
      simulateGaze(walk(), kScreen, 500, 5, {.noise_deg = 0.1, .blink_rate_Hz = 0.0}).trace;
  const auto offline = labelTrained(trace, kScreen, {}, builtinEventModel()),
             online = labelTrainedOnline(trace, kScreen, {}, builtinEventModel());
  int saccades = 0;
  for (std::size_t i = 0; i < offline.size(); ++i) {
    EXPECT_EQ(isStable(offline[i].state), isStable(online[i].state)) << i;
    saccades += offline[i].state == GazeState::saccade ? 1 : 0;
  }
  EXPECT_GT(saccades, 100);
}

// Noise splits movements and rests at any rate; coders hardly label rests below 40 ms.
TEST(LabelTrained, KnowsFewerShortRestsThanOnline) {
  const auto countShortRests = [](const std::vector<SampleLabel>& labels, double rate_Hz) {
    int rests = 0;
    for (std::size_t i = 0; i < labels.size();) {
      std::size_t end = i + 1;
      const bool rest = isStable(labels[i].state);
      while (end < labels.size() && isStable(labels[end].state) == rest) ++end;
      const bool inside = i > 0 && end < labels.size();
      rests += rest && inside && static_cast<double>(end - i) / rate_Hz < 0.04 ? 1 : 0;
      i = end;
    }
    return rests;
  };
  int offline = 0, online = 0;
  for (const double rate_Hz : {60.0, 120.0, 250.0, 1000.0}) {
    for (const double noise_deg : {0.1, 0.5, 1.0}) {
      const GazeTrace trace =
          simulateGaze(walk(), kScreen, rate_Hz, 7, {.noise_deg = noise_deg, .blink_rate_Hz = 0.3})
              .trace;
      offline += countShortRests(labelTrained(trace, kScreen, {}, builtinEventModel()), rate_Hz);
      online +=
          countShortRests(labelTrainedOnline(trace, kScreen, {}, builtinEventModel()), rate_Hz);
    }
  }
  EXPECT_GT(online, 10);
  EXPECT_LT(3 * offline, online);
}

// A lid moves the pupil's image as it closes and opens.
TEST(LabelTrained, GivesMovementBesideABlinkToTheBlink) {
  SimulatedGaze gaze =
      simulateGaze(walk(), kScreen, 500, 9, {.noise_deg = 0.1, .blink_rate_Hz = 0.0});
  auto& samples = gaze.trace.samples;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double t_s = samples[i].time_s - 3.3;  // of 0.15 s, with lids of 0.03 s on both sides
    if (t_s < -0.03 || t_s > 0.18 || !samples[i].point_px) continue;
    const double closed = t_s < 0.0    ? 1.0 + t_s / 0.03
                          : t_s > 0.15 ? 1.0 - (t_s - 0.15) / 0.03
                                       : 1.0;
    samples[i].point_px->y += 300.0 * closed;
    if (closed == 1.0) samples[i].point_px.reset();
  }
  const auto labels = labelTrained(gaze.trace, kScreen, {}, builtinEventModel());
  int blinks = 0;
  for (std::size_t i = 1; i < labels.size(); ++i) {
    blinks += labels[i].state == GazeState::blink ? 1 : 0;
    const bool beside =
        (labels[i].state == GazeState::blink) != (labels[i - 1].state == GazeState::blink);
    EXPECT_TRUE(!beside || isStable(labels[i].state) || isStable(labels[i - 1].state)) << i;
    double sum = 0.0;
    for (const double each : labels[i].probabilities) sum += each;
    EXPECT_NEAR(sum, 1.0, 1e-9) << i;
  }
  EXPECT_GT(blinks, 80);
}

// What follows a target for so short a time is a drift, unless it goes on behind a saccade.
TEST(LabelTrained, KnowsNoPursuitBelow300Milliseconds) {
  const GazeTrace trace =
      simulateGaze(walk(), kScreen, 250, 11, {.noise_deg = 0.4, .blink_rate_Hz = 0.2}).trace;
  const auto labels = labelTrained(trace, kScreen, {}, builtinEventModel());
  double duration_s = 0.0;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (labels[i].state == GazeState::pursuit) {
      duration_s += 1.0 / trace.rate_Hz;
    } else if (labels[i].state != GazeState::saccade && labels[i].state != GazeState::oscillation) {
      EXPECT_TRUE(duration_s == 0.0 || duration_s > 0.299) << i;
      duration_s = 0.0;
    }
  }
}

// The same with doubts about the signal, by any detector.
TEST(LabelEvents, OnlineDoNotDependOnLaterSamples) {
  SimulatedGaze gaze = simulateGaze({{{500, 500}, 1.5}, {{1200, 700}, 1.5}, {{700, 300}, 1.0}},
                                    kScreen, 60, 5, {.noise_deg = 0.1, .blink_rate_Hz = 0.5});
  gaze.trace.simulated = false;
  auto& samples = gaze.trace.samples;
  for (std::size_t i = 30; i < 110; ++i) samples[i].point_px = glm::dvec2(400, 300);
  for (std::size_t i = 140; i < 200; ++i) {
    if (i % 3 != 0) samples[i].point_px.reset();
  }
  for (const Detector detector : kDetectors) {
    const EventSettings settings{.detector = detector};
    const auto all = labelEvents(gaze.trace, kScreen, settings, true).states;
    if (detector != Detector::rules) {
      EXPECT_GT(std::count(all.begin(), all.end(), GazeState::unjudged), 20) << nameOf(detector);
    }
    for (std::size_t end = 20; end <= samples.size(); ++end) {
      GazeTrace cut = gaze.trace;
      cut.samples.resize(end);
      const auto states = labelEvents(cut, kScreen, settings, true).states;
      const std::size_t known = end - OnlineEvents(kScreen, 60, settings).delaySamples();
      for (std::size_t i = 0; i < known; ++i) {
        ASSERT_EQ(states[i], all[i]) << nameOf(detector) << ", cut after " << end << ", at " << i;
      }
    }
  }
}

// Pupils in an eye camera: the unit of the positions is not known.
TEST(LabelEvents, OfAnUncalibratedSignalDoNotDependOnItsScale) {
  const SimulatedGaze gaze = simulateGaze(walk(), kScreen, 120, 5, {.noise_deg = 0.1});
  std::vector<std::vector<GazeState>> labels;
  for (const double scale : {1.0, 0.25}) {
    const ScratchFile file([&] {
      std::string table = "# units=relative\ntime_s\tx\ty\n";
      for (const GazeSample& sample : gaze.trace.samples) {
        const glm::dvec2 point = sample.point_px.value_or(glm::dvec2(NAN));
        table += exactText(sample.time_s) + '\t' + exactText(scale * point.x + 7.0) + '\t' +
                 exactText(scale * point.y - 3.0) + '\n';
      }
      return table;
    }());
    const GazeTrace trace = readTrace(file.path(), {}, kScreen);
    ASSERT_TRUE(trace.relative);
    const EventLabels found = labelEvents(trace, *trace.screen);
    const auto events = eventsOf(found, trace, *trace.screen, {});
    labels.push_back(found.states);
    EXPECT_GE(std::count_if(events.begin(), events.end(),
                            [](const auto& event) { return event.kind == GazeState::saccade; }),
              11);
    for (const GazeEvent& event : events) {
      EXPECT_FALSE(event.amplitude_deg || event.peak_velocity_deg_s || event.position_px);
    }
    const RecordingQuality quality = qualityOf(trace, *trace.screen, found.states, events);
    EXPECT_FALSE(quality.rms_s2s_deg || quality.sd_deg || quality.main_sequence);
  }
  EXPECT_EQ(labels[0], labels[1]);
}

TEST(LabelEvents, HaveProbabilitiesThatSumToOne) {
  const SimulatedGaze gaze = simulateGaze(walk(), kScreen, 250, 3, {.blink_rate_Hz = 0.5});
  for (const bool online : {false, true}) {
    const EventLabels labels = labelEvents(gaze.trace, kScreen, {}, online);
    for (const auto& of_sample : labels.probabilities) {
      EXPECT_NEAR(std::accumulate(of_sample.begin(), of_sample.end(), 0.0), 1.0, 1e-9);
      for (const double each : of_sample) EXPECT_GE(each, 0.0);
    }
    for (const GazeEvent& event : eventsOf(labels, gaze.trace, kScreen, {})) {
      EXPECT_TRUE(event.probability && *event.probability >= 0.0 && *event.probability <= 1.0);
    }
  }
}

TEST(LabelEvents, WithoutPursuitFollowedTargetsAreFixated) {
  GazeTrace trace;
  trace.rate_Hz = 250.0;
  Screen screen = kScreen;
  std::mt19937 random(2);
  std::normal_distribution<double> noise_px(0.0, 1.0);
  for (int i = 0; i < 1000; ++i) {
    const double x = 300.0 + (i > 300 ? 1.2 * (i - 300) : 0.0);
    trace.samples.push_back({.time_s = i / 250.0,
                             .point_px = glm::dvec2(x + noise_px(random), 500 + noise_px(random))});
  }
  for (const bool online : {false, true}) {
    const auto with = labelEvents(trace, screen, {}, online).states;
    const auto without = labelEvents(trace, screen, {.pursuit = false}, online).states;
    EXPECT_GT(std::count(with.begin(), with.end(), GazeState::pursuit), 350) << online;
    EXPECT_EQ(std::count(without.begin(), without.end(), GazeState::pursuit), 0) << online;
  }
}

/// Gaze that rests in the world and jumps, seen from a head that turns by `turn_deg` to each side.
GazeTrace headsetTrace(double rate_Hz, double turn_deg, bool knows_head) {
  GazeTrace trace{{.format = "simulated", .screen = headsetScreen({}, 12.0)}, rate_Hz};
  trace.field = EyeField{};
  std::mt19937 random(4);
  std::normal_distribution<double> noise_rad(0.0, glm::radians(0.05));
  for (int i = 0; i < static_cast<int>(5.0 * rate_Hz); ++i) {
    const double time_s = i / rate_Hz;
    const double yaw_rad = glm::radians(turn_deg) * std::sin(2.0 * time_s);
    const double up_rad = glm::radians(8.0 * (static_cast<int>(time_s / 0.5) % 2));
    const double a = up_rad + noise_rad(random), b = noise_rad(random);
    const glm::dvec3 world = glm::normalize(glm::dvec3(std::tan(b), std::tan(a), -1.0));
    const glm::dquat head = glm::angleAxis(yaw_rad, glm::dvec3(0.0, 1.0, 0.0));
    GazeSample sample{.time_s = time_s};
    if (knows_head) sample.head = HeadInWorld{.world_from_head = head};
    sample.direction = glm::conjugate(head) * world;
    sample.point_px = pointOnScreen_px(*trace.screen, *sample.direction);
    trace.samples.push_back(sample);
  }
  return trace;
}

TEST(LabelEvents, DoNotChangeIfTheHeadTurns) {
  for (const double rate_Hz : {72.0, 90.0, 120.0}) {
    const GazeTrace still = headsetTrace(rate_Hz, 0.0, true),
                    turning = headsetTrace(rate_Hz, 25.0, true);
    for (const bool online : {false, true}) {
      const auto a = labelEvents(still, *still.screen, {}, online).states;
      const auto b = labelEvents(turning, *turning.screen, {}, online).states;
      EXPECT_EQ(a, b) << rate_Hz;
      EXPECT_GE(std::count(a.begin(), a.end(), GazeState::saccade), 9) << rate_Hz;
    }
  }
}

TEST(LabelEvents, WithoutHeadPosesTurnsAreNoPursuitUnlessAsked) {
  const GazeTrace turning = headsetTrace(90.0, 25.0, false);
  const auto count = [&](std::optional<bool> pursuit) {
    const auto states = labelEvents(turning, *turning.screen, {.pursuit = pursuit}).states;
    return std::count(states.begin(), states.end(), GazeState::pursuit);
  };
  EXPECT_EQ(count(std::nullopt), 0);
  EXPECT_GT(count(true), 50);
}

// Angles that were rounded to 0.1 degree move by whole steps, which are no saccades.
TEST(LabelEvents, RoundedAnglesAreNoSaccades) {
  for (const double rate_Hz : {72.0, 120.0, 250.0}) {
    GazeTrace trace;
    trace.rate_Hz = rate_Hz;
    std::mt19937 random(4);
    std::normal_distribution<double> noise_deg(0.0, 0.03);
    for (int i = 0; i < static_cast<int>(6.0 * rate_Hz); ++i) {
      const double drift_deg = 0.4 * std::sin(0.9 * i / rate_Hz);
      const auto rounded = [](double deg) { return 0.1 * std::round(deg / 0.1); };
      trace.samples.push_back(
          {.time_s = i / rate_Hz,
           .point_px = pointAtEccentricity_px(
               kScreen, {rounded(drift_deg + noise_deg(random)), rounded(noise_deg(random))})});
    }
    for (const bool online : {false, true}) {
      const auto states = labelEvents(trace, kScreen, {}, online).states;
      EXPECT_EQ(std::count(states.begin(), states.end(), GazeState::saccade), 0) << rate_Hz;
    }
  }
}

}  // namespace FOCI_FILE
}  // namespace foci
