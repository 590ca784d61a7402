#include "gaze/events/trained_events.h"

#include <algorithm>

#include "gaze/events/gaze_speed.h"
#include "gaze/geometry/line_of_sight.h"

namespace foci {
namespace {

constexpr double kNoise_s = 3.0;  // the noise is that of so long a time before
// Offline, slower trackers are judged in hindsight too: the path so far misses a saccade of one
// sample. At higher rates the path through the whole recording ends oscillations earlier than some
// coders do, so that GazeCom and pictures left out agree less.
constexpr double kHindsightBelow_Hz = 225.0;
// What coders do not label. The values are those of sets left out. Evidence is that of
// `ViterbiPath`: a shorter rest is given up where less than `kSureStable_s` is for it. A movement
// is given up for `kPreferStable_s` more than a rest.
constexpr double kMinStable_s = 0.04, kSureStable_s = 0.005, kPreferStable_s = 0.02;
constexpr double kMinPursuit_s = 0.3;         // with the saccades that catch up with the target
constexpr double kPriorPursuit = 0.3;         // where gaze is stable for too few samples
constexpr double kMinOscillation_Hz = 100.0;  // below, an oscillation has two samples at most

std::size_t indexOf(Motion motion) { return static_cast<std::size_t>(motion); }

double probabilityOfSecond(const BoostedTrees& trees, std::span<const float> features) {
  std::array<double, 2> both{};
  trees.probabilities(features, both);
  return both[1];
}

/// A label with the probabilities of all states.
/// @param gone  of blink and lost, the one that applies here
SampleLabel labelOf(GazeState state, GazeState gone, const std::array<double, 3>& motion,
                    double oscillation, double pursuit, const std::vector<CalibrationKnot>& knots) {
  SampleLabel label{.state = state};
  const auto of = [&](GazeState each) -> double& {
    return label.probabilities[static_cast<std::size_t>(each)];
  };
  of(GazeState::fixation) = motion[0] * (1.0 - pursuit);
  of(GazeState::pursuit) = motion[0] * pursuit;
  of(GazeState::saccade) = motion[1] * (1.0 - oscillation);
  of(GazeState::oscillation) = motion[1] * oscillation;
  of(gone) = motion[2];
  const double stated = of(state), right = calibrated(stated, knots);
  if (stated > 1.0 - 1e-9) return label;  // known without the trees (`setGone`)
  for (double& each : label.probabilities) each *= (1.0 - right) / (1.0 - stated);
  of(state) = right;
  return label;
}

/// Lookahead of the features: the largest level within the delay.
const ModelLevel& levelFor(const EventModel& model, double delay_s) {
  std::size_t best = 0;
  for (std::size_t i = 0; i < model.levels.size(); ++i) {
    if (model.levels[i].ahead_s <= delay_s + 1e-6) best = i;
  }
  return model.levels[best];
}

std::size_t samplesWithin(double span_s, double rate_Hz) {
  constexpr double kRounding = 1e-6;  // samples; keeps a span of n intervals at n samples
  return static_cast<std::size_t>(span_s * rate_Hz + kRounding);
}

/// What certain knowledge leaves of the first step: the tracker reports a blink, or gaze is missing
/// for too long to be bridged.
void setGone(std::array<double, 3>& motion) { motion = {0.0, 0.0, 1.0}; }

}  // namespace

TrainedEvents::TrainedEvents(double rate_Hz, const EventSettings& settings, const EventModel& model)
    : rate_Hz_(rate_Hz),
      settings_(settings),
      level_(&levelFor(model, settings.delay_s)),
      mode_(&model.online),
      delay_(samplesWithin(settings.delay_s, rate_Hz)),
      feature_delay_(std::min(samplesWithin(level_->ahead_s, rate_Hz), delay_)),
      features_(rate_Hz, kNoise_s),
      motion_path_(model.motion_switch_s),
      oscillation_path_(model.oscillation_switch_s),
      pursuit_path_(model.pursuit_switch_s) {}

std::optional<SampleLabel> TrainedEvents::push(const GazeSample& sample, const TimedSight& sight,
                                               const std::optional<glm::dvec3>& in_head) {
  Pending next{.sight = sight, .blink = sample.blink, .step_s = 1.0 / rate_Hz_};
  if (newest_s_) next.step_s = std::min(sight.time_s - *newest_s_, longestStep_s(rate_Hz_));
  newest_s_ = sight.time_s;
  if (sight.direction) {
    last_present_s_ = sight.time_s;
  } else {
    next.missing_s = last_present_s_ ? sight.time_s - *last_present_s_ : 1e9;
  }
  pending_.push_back(next);
  features_.push(sight, in_head);
  if (pending_.size() > feature_delay_ + judged_) judgeNext();
  features_.forgetBefore(labelled_ + judged_);
  return pending_.size() > delay_ ? std::optional(settle()) : std::nullopt;
}

std::optional<SampleLabel> TrainedEvents::settleNext() {
  if (pending_.empty()) return std::nullopt;
  if (judged_ < pending_.size()) judgeNext();
  return settle();
}

/// Takes the oldest sample that has not passed the first step through it.
void TrainedEvents::judgeNext() {
  Pending& pending = pending_[judged_];
  const GazeFeatureVector features =
      features_.of(labelled_ + judged_, std::min(level_->ahead_s, settings_.delay_s));
  level_->motion.probabilities(features, pending.motion);
  if (pending.blink || pending.missing_s > settings_.max_gap_s) setGone(pending.motion);
  if (rate_Hz_ >= kMinOscillation_Hz && pending.motion[1] > 0.05) {
    pending.oscillation = probabilityOfSecond(level_->oscillation, features);
  }
  pending.from = motion_path_.push(pending.motion, pending.step_s);
  ++judged_;
}

/// The state of the oldest sample on the most likely path.
std::size_t TrainedEvents::motionOfOldest() const {
  std::size_t state = motion_path_.bestState();
  for (std::size_t i = judged_; i-- > 1;) state = pending_[i].from[state];
  return state;
}

SampleLabel TrainedEvents::settle() {
  const auto motion = static_cast<Motion>(motionOfOldest());
  const Pending& now = pending_.front();
  const bool begins = motion != motion_;
  GazeState state = GazeState::fixation, gone = GazeState::blink;
  double pursuit = 0.0;
  if (!now.blink && now.missing_s > settings_.max_blink_s) gone = GazeState::lost;
  if (motion == Motion::moving) {
    if (begins) oscillation_path_.restartIn(0);
    const double q = now.oscillation;
    oscillation_path_.push({1.0 - q, q}, now.step_s);
    state = oscillation_path_.bestState() == 1 ? GazeState::oscillation : GazeState::saccade;
  } else if (motion == Motion::gone) {
    state = gone;
  }
  const bool broken = now.step_s >= longestStep_s(rate_Hz_);
  if (motion != Motion::stable || broken) {
    if (stable_.count() >= 3.0) {
      before_that_ = before_;
      before_ = stable_;
    }
    stable_ = {};
    near_.clear();
  }
  if (motion == Motion::stable) {
    if (now.sight.direction) {
      stable_.add(now.sight.time_s, *now.sight.direction);
      near_.push_back(now.sight);
      while (now.sight.time_s - near_.front().time_s > kPursuitWindow_s) near_.pop_front();
    }
    if (settings_.pursuit.value_or(true)) {
      pursuit = pursuitOf(now);
      pursuit_path_.push({1.0 - pursuit, pursuit}, now.step_s);
      if (pursuit_path_.bestState() == 1) state = GazeState::pursuit;
    }
  } else if (motion == Motion::gone) {
    pursuit_path_.restart();
  }
  motion_ = motion;
  const SampleLabel label =
      labelOf(state, gone, now.motion, now.oscillation, pursuit, mode_->calibration);
  pending_.pop_front();
  --judged_;
  ++labelled_;
  return label;
}

/// The probability of pursuit, given that gaze is stable.
double TrainedEvents::pursuitOf(const Pending& now) {
  if (stable_.count() < 3.0) return kPriorPursuit;
  StableContext context{.whole = &stable_,
                        .near = {},
                        .time_s = now.sight.time_s,
                        .noise_deg = features_.noise_deg()};
  const std::vector<TimedSight> near(near_.begin(), near_.end());
  context.near = near;
  if (before_.count() > 0.0 && stable_.first_s() - before_.newest_s() <= kNeighbour_s) {
    context.before = &before_;
    if (before_.first_s() - before_that_.newest_s() <= kNeighbour_s) {
      context.before_that = &before_that_;
    }
  }
  const PursuitFeatureVector features = pursuitFeatures(context);
  if (take_pursuit_) take_pursuit_(labelled_, features);
  return probabilityOfSecond(mode_->pursuit, features);
}

namespace {

/// The samples of a complete recording on their way to labels.
class WholeRecording {
 public:
  WholeRecording(const GazeTrace& trace, const Screen& screen, const EventSettings& settings,
                 const EventModel& model)
      : trace_(trace), settings_(settings), model_(model), count_(trace.samples.size()) {
    for (const GazeSample& sample : trace.samples) {
      sights_.push_back({sample.time_s, sightInWorld(sample, screen)});
    }
    judgeMotion(screen);
    findPath();
  }

  std::vector<SampleLabel> label(const TakePursuit& take_pursuit) {
    std::vector<GazeState> states(count_, GazeState::fixation), gone(count_, GazeState::blink);
    std::vector<double> pursuit(count_, 0.0);
    for (std::size_t i = 0; i < count_; ++i) {
      if (missing_s_[i] > settings_.max_blink_s && !trace_.samples[i].blink) {
        gone[i] = GazeState::lost;
      }
      if (motion_[i] == indexOf(Motion::gone)) states[i] = gone[i];
    }
    ViterbiPath<2> path(model_.oscillation_switch_s);
    path.restartIn(0);
    split(Motion::moving, {}, path, oscillation_, {GazeState::saccade, GazeState::oscillation},
          states);
    giveLidsToBlinks(states);
    if (settings_.pursuit.value_or(true)) labelPursuit(states, pursuit, take_pursuit);
    std::vector<SampleLabel> labels;
    for (std::size_t i = 0; i < count_; ++i) {
      labels.push_back(labelOf(states[i], gone[i], probabilities_[i], oscillation_[i], pursuit[i],
                               model_.offline.calibration));
    }
    return labels;
  }

  /// Calls `take` for each sample of stable gaze whose pursuit can be judged.
  void forStableGaze(const TakePursuit& take) const {
    std::vector<Run> spans = runsOfMotion();
    std::erase_if(spans, [](const Run& run) { return run.motion != indexOf(Motion::stable); });
    std::vector<DriftLine> lines;
    std::vector<std::size_t> of_line;
    for (std::size_t s = 0; s < spans.size(); ++s) {
      DriftLine line;
      for (std::size_t i = spans[s].first; i < spans[s].end; ++i) {
        if (sights_[i].direction) line.add(sights_[i].time_s, *sights_[i].direction);
      }
      if (line.count() < 3.0) continue;
      lines.push_back(line);
      of_line.push_back(s);
    }
    const auto neighbour = [&](std::size_t a, std::size_t b) -> const DriftLine* {
      // From line a to its later neighbour b, or back.
      if (b >= lines.size()) return nullptr;
      const double apart_s = a < b ? lines[b].first_s() - lines[a].newest_s()
                                   : lines[a].first_s() - lines[b].newest_s();
      return apart_s <= kNeighbour_s ? &lines[b] : nullptr;
    };
    for (std::size_t k = 0; k < lines.size(); ++k) {
      const std::size_t first = spans[of_line[k]].first, end = spans[of_line[k]].end;
      StableContext context{.whole = &lines[k], .near = {}, .centred = true};
      context.before = neighbour(k, k - 1);
      if (context.before) context.before_that = neighbour(k - 1, k - 2);
      context.after = neighbour(k, k + 1);
      std::size_t from = first, until = first;
      for (std::size_t i = first; i < end; ++i) {
        while (sights_[i].time_s - sights_[from].time_s > 0.5 * kPursuitWindow_s + 1e-5) ++from;
        while (until < end &&
               sights_[until].time_s - sights_[i].time_s <= 0.5 * kPursuitWindow_s + 1e-5) {
          ++until;
        }
        context.near = std::span(sights_).subspan(from, until - from);
        context.time_s = sights_[i].time_s;
        context.noise_deg = noise_deg_[i];
        take(i, pursuitFeatures(context));
      }
    }
  }

 private:
  void judgeMotion(const Screen& screen) {
    std::vector<const ModelLevel*> levels;
    for (const ModelLevel& level : model_.levels) {
      const bool needed = levels.empty() || trace_.rate_Hz < kHindsightBelow_Hz;
      if (level.ahead_s > 0.0 && needed) levels.push_back(&level);
    }
    GazeFeatures features(trace_.rate_Hz, kNoise_s);
    const std::size_t ahead = samplesWithin(levels.back()->ahead_s, trace_.rate_Hz);
    for (std::size_t pushed = 0, next = 0; next < count_; ++next) {
      for (; pushed < std::min(next + ahead + 1, count_); ++pushed) {
        const auto& point = trace_.samples[pushed].point_px;
        features.push(sights_[pushed],
                      point ? std::optional(lineOfSight(screen, *point)) : std::nullopt);
      }
      std::array<double, 3> motion{};
      double oscillation = 0.0;
      for (const ModelLevel* level : levels) {
        const GazeFeatureVector values = features.of(next, level->ahead_s);
        std::array<double, 3> each{};
        level->motion.probabilities(values, each);
        const double share = 1.0 / static_cast<double>(levels.size());
        for (std::size_t k = 0; k < 3; ++k) motion[k] += share * each[k];
        if (trace_.rate_Hz >= kMinOscillation_Hz && each[1] > 0.05) {
          oscillation += share * probabilityOfSecond(level->oscillation, values);
        }
      }
      probabilities_.push_back(motion);
      oscillation_.push_back(oscillation);
      noise_deg_.push_back(features.noise_deg());
      features.forgetBefore(next);
    }

    missing_s_.assign(count_, 0.0);
    for (std::size_t i = 0; i < count_;) {
      std::size_t end = i + 1;
      if (!sights_[i].direction) {
        while (end < count_ && !sights_[end].direction) ++end;
        const double gap_s =
            (end < count_ ? sights_[end].time_s : sights_[end - 1].time_s + 1.0 / trace_.rate_Hz) -
            sights_[i].time_s;
        std::ranges::fill(std::span(missing_s_).subspan(i, end - i), gap_s);
      }
      i = end;
    }
    for (std::size_t i = 0; i < count_; ++i) {
      if (trace_.samples[i].blink || missing_s_[i] > settings_.max_gap_s + 1e-9) {
        setGone(probabilities_[i]);
      }
    }
  }

  bool isBroken(std::size_t i) const {
    return i > 0 && sights_[i].time_s - sights_[i - 1].time_s >= longestStep_s(trace_.rate_Hz);
  }

  double step_s(std::size_t i) const {
    return i == 0
               ? 1.0 / trace_.rate_Hz
               : std::min(sights_[i].time_s - sights_[i - 1].time_s, longestStep_s(trace_.rate_Hz));
  }

  /// The end of the most likely path up to each sample. Below `kHindsightBelow_Hz`, what moves on
  /// the path through the whole recording moves too.
  void findPath() {
    ViterbiPath<3> path(model_.motion_switch_s);
    std::vector<Evidence<3>> evidence;
    for (std::size_t i = 0; i < count_; ++i) {
      evidence.push_back({probabilities_[i], step_s(i)});
      path.push(probabilities_[i], step_s(i));
      motion_.push_back(path.bestState());
    }
    if (trace_.rate_Hz < kHindsightBelow_Hz) {
      const auto whole = mostLikelyStates(ViterbiPath<3>(model_.motion_switch_s), evidence);
      for (std::size_t i = 0; i < count_; ++i) {
        const auto stable = indexOf(Motion::stable), moving = indexOf(Motion::moving);
        if (motion_[i] == stable && whole[i] == moving) motion_[i] = moving;
      }
    }
    removeShortStable();
  }

  /// Samples [first, end) with one motion and no break.
  struct Run {
    std::size_t first = 0, end = 0;
    std::size_t motion = 0;
  };

  std::vector<Run> runsOfMotion() const {
    std::vector<Run> runs;
    for (std::size_t i = 0; i < count_; ++i) {
      if (i == 0 || motion_[i] != motion_[i - 1] || isBroken(i)) runs.push_back({i, i, motion_[i]});
      runs.back().end = i + 1;
    }
    return runs;
  }

  /// Gaze hardly rests for less than `kMinStable_s`. Either the rest belongs to what is before or
  /// after it, unless the trees are sure of it, or one of these, if another rest is beyond it, is a
  /// rest too: whichever has the least evidence against it.
  void removeShortStable() {
    constexpr double kLeast = 1e-4;  // as in `ViterbiPath`
    constexpr auto kStable = static_cast<std::size_t>(Motion::stable);
    std::vector<std::array<double, 3>> sums_s = {{}};  // of log probabilities up to each sample
    for (std::size_t i = 0; i < count_; ++i) {
      sums_s.push_back(sums_s.back());
      for (std::size_t k = 0; k < 3; ++k) {
        sums_s.back()[k] += step_s(i) * std::log(probabilities_[i][k] + kLeast);
      }
    }
    const auto evidence_s = [&](const Run& run, std::size_t other) {
      const auto &from = sums_s[run.first], &until = sums_s[run.end];
      return until[run.motion] - from[run.motion] - (until[other] - from[other]);
    };
    std::vector<Run> done;
    const auto add = [&](const Run& run) {
      if (!done.empty() && done.back().motion == run.motion && !isBroken(run.first)) {
        done.back().end = run.end;
      } else {
        done.push_back(run);
      }
    };
    const std::vector<Run> runs = runsOfMotion();
    for (std::size_t r = 0; r < runs.size(); ++r) {
      add(runs[r]);
      if (done.size() < 3) continue;
      const Run before = done[done.size() - 3], rest = done[done.size() - 2], after = done.back();
      const double duration_s = static_cast<double>(rest.end - rest.first) / trace_.rate_Hz;
      if (rest.motion != kStable || duration_s >= kMinStable_s || isBroken(rest.first) ||
          isBroken(rest.end)) {
        continue;
      }
      std::array<std::size_t, 3> motions = {before.motion, before.motion, after.motion};
      double least_s = evidence_s(rest, before.motion);
      const auto consider = [&](double against_s, const std::array<std::size_t, 3>& changed) {
        if (against_s >= least_s) return;
        least_s = against_s;
        motions = changed;
      };
      consider(evidence_s(rest, after.motion), {before.motion, after.motion, after.motion});
      const bool follows_rest =
          done.size() > 3 && done[done.size() - 4].motion == kStable && !isBroken(before.first);
      const bool precedes_rest =
          r + 1 < runs.size() && runs[r + 1].motion == kStable && !isBroken(after.end);
      if (follows_rest) {
        consider(evidence_s(before, kStable) - kPreferStable_s, {kStable, kStable, after.motion});
      }
      if (precedes_rest) {
        consider(evidence_s(after, kStable) - kPreferStable_s, {before.motion, kStable, kStable});
      }
      if (motions[1] != kStable && least_s >= kSureStable_s) continue;
      done.resize(done.size() - 3);
      add({before.first, before.end, motions[0]});
      add({rest.first, rest.end, motions[1]});
      add({after.first, after.end, motions[2]});
    }
    for (const Run& run : done) {
      std::ranges::fill(std::span(motion_).subspan(run.first, run.end - run.first), run.motion);
    }
  }

  /// Labels the samples of a motion with two states, by the most likely path through each run.
  /// @param across  a motion that does not end a run
  void split(Motion motion, std::optional<Motion> across, const ViterbiPath<2>& path,
             const std::vector<double>& second, const std::array<GazeState, 2>& names,
             std::vector<GazeState>& states) const {
    std::vector<std::size_t> run;
    std::vector<Evidence<2>> evidence;
    for (std::size_t i = 0; i <= count_; ++i) {
      if (i < count_ && motion_[i] == indexOf(motion)) {
        run.push_back(i);
        evidence.push_back({{1.0 - second[i], second[i]}, step_s(i)});
      } else if (i == count_ || !across || motion_[i] != indexOf(*across)) {
        const auto found = mostLikelyStates(path, evidence);
        for (std::size_t k = 0; k < run.size(); ++k) states[run[k]] = names[found[k]];
        run.clear();
        evidence.clear();
      }
    }
  }

  /// What moves right before or after a blink is the lid.
  void giveLidsToBlinks(std::vector<GazeState>& states) {
    for (const Run& run : runsOfMotion()) {
      const bool lid = (run.first > 0 && states[run.first - 1] == GazeState::blink) ||
                       (run.end < count_ && states[run.end] == GazeState::blink);
      if (run.motion != indexOf(Motion::moving) || !lid) continue;
      for (std::size_t i = run.first; i < run.end; ++i) {
        states[i] = GazeState::blink;
        std::array<double, 3>& p = probabilities_[i];
        p = {p[0], 0.0, p[1] + p[2]};
      }
    }
  }

  void labelPursuit(std::vector<GazeState>& states, std::vector<double>& pursuit,
                    const TakePursuit& take_pursuit) const {
    for (std::size_t i = 0; i < count_; ++i) {
      if (motion_[i] == indexOf(Motion::stable)) pursuit[i] = kPriorPursuit;
    }
    forStableGaze([&](std::size_t i, const PursuitFeatureVector& features) {
      if (take_pursuit) take_pursuit(i, features);
      pursuit[i] = probabilityOfSecond(model_.offline.pursuit, features);
    });
    split(Motion::stable, Motion::moving, ViterbiPath<2>(model_.pursuit_switch_s), pursuit,
          {GazeState::fixation, GazeState::pursuit}, states);
    removeShortPursuit(states);
  }

  void removeShortPursuit(std::vector<GazeState>& states) const {
    std::vector<std::size_t> pursued;
    double duration_s = 0.0;
    for (std::size_t i = 0; i <= count_; ++i) {
      if (i < count_ && states[i] == GazeState::pursuit) {
        pursued.push_back(i);
        duration_s += step_s(i);
      } else if (i == count_ || motion_[i] != indexOf(Motion::moving)) {
        for (std::size_t j : pursued) {
          if (duration_s < kMinPursuit_s) states[j] = GazeState::fixation;
        }
        pursued.clear();
        duration_s = 0.0;
      }
    }
  }

  const GazeTrace& trace_;
  const EventSettings& settings_;
  const EventModel& model_;
  std::size_t count_;
  std::vector<TimedSight> sights_{};
  std::vector<std::array<double, 3>> probabilities_{};
  std::vector<double> oscillation_{}, noise_deg_{}, missing_s_{};
  std::vector<std::size_t> motion_{};
};

}  // namespace

std::vector<SampleLabel> labelTrained(const GazeTrace& trace, const Screen& screen,
                                      const EventSettings& settings, const EventModel& model,
                                      const TakePursuit& take) {
  return WholeRecording(trace, screen, settings, model).label(take);
}

std::vector<SampleLabel> labelTrainedOnline(const GazeTrace& trace, const Screen& screen,
                                            const EventSettings& settings, const EventModel& model,
                                            const TakePursuit& take) {
  TrainedEvents events(trace.rate_Hz, settings, model);
  events.onPursuit(take);
  std::vector<SampleLabel> labels;
  labels.reserve(trace.samples.size());
  for (const GazeSample& sample : trace.samples) {
    const auto in_head =
        sample.point_px ? std::optional(lineOfSight(screen, *sample.point_px)) : std::nullopt;
    const auto label = events.push(sample, {sample.time_s, sightInWorld(sample, screen)}, in_head);
    if (label) labels.push_back(*label);
  }
  while (labels.size() < trace.samples.size()) labels.push_back(*events.settleNext());
  return labels;
}

}  // namespace foci
