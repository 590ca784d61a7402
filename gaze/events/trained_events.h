// The trained detector: boosted trees on features of gaze, smoothed by hidden Markov models whose
// most likely path is taken (Viterbi 1967).
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "gaze/events/event_model.h"
#include "gaze/events/event_settings.h"
#include "gaze/events/gaze_features.h"
#include "gaze/events/pursuit.h"
#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// The most likely path of K states while probabilities arrive. Neighbouring samples are not
/// independent: a sample stands for the time to the next one, so that evidence is the integral of
/// the log probability over time, at any sampling rate. A change of the state costs `switch_s` of
/// it. A shorter and less certain event than this is noise.
template <std::size_t K>
class ViterbiPath {
 public:
  /// From where each state is reached best; with the states of all samples it is the path.
  using From = std::array<std::uint8_t, K>;

  explicit ViterbiPath(double switch_s) : switch_s_(switch_s) {}

  /// @param step_s  time that the sample stands for
  From push(const std::array<double, K>& probabilities, double step_s) {
    constexpr double kLeast = 1e-4;  // nothing is impossible
    From from{};
    std::array<double, K> next{};
    const std::size_t best = bestState();
    for (std::size_t k = 0; k < K; ++k) {
      const double changed = scores_[best] - switch_s_;
      from[k] = static_cast<std::uint8_t>(scores_[k] >= changed ? k : best);
      next[k] = std::max(scores_[k], changed) + step_s * std::log(probabilities[k] + kLeast);
    }
    // Only differences count.
    scores_ = next;
    const double top = scores_[bestState()];
    for (double& score : scores_) score -= top;
    return from;
  }

  /// The end of the most likely path up to the newest sample. Equal scores: the first state.
  std::size_t bestState() const {
    std::size_t best = 0;
    for (std::size_t k = 1; k < K; ++k) best = scores_[k] > scores_[best] ? k : best;
    return best;
  }

  /// Forgets the past; the next sample begins in any state, or in the given one.
  void restart() { scores_ = {}; }
  void restartIn(std::size_t state) {
    scores_.fill(-switch_s_);
    scores_[state] = 0.0;
  }

 private:
  double switch_s_;
  std::array<double, K> scores_{};
};

/// What a sample tells `ViterbiPath::push`.
template <std::size_t K>
struct Evidence {
  std::array<double, K> probabilities{};
  double step_s = 0.0;
};

/// The states of the most likely path through all samples.
template <std::size_t K>
std::vector<std::size_t> mostLikelyStates(ViterbiPath<K> path,
                                          const std::vector<Evidence<K>>& samples) {
  std::vector<typename ViterbiPath<K>::From> from;
  from.reserve(samples.size());
  for (const Evidence<K>& each : samples)
    from.push_back(path.push(each.probabilities, each.step_s));
  std::vector<std::size_t> states(samples.size());
  std::size_t state = path.bestState();
  for (std::size_t i = samples.size(); i-- > 0;) {
    states[i] = state;
    state = from[i][state];
  }
  return states;
}

/// A label, and the probability of every `GazeState`. They sum to 1.
struct SampleLabel {
  GazeState state = GazeState::lost;
  std::array<double, kGazeStates> probabilities{};

  double confidence() const { return probabilities[static_cast<std::size_t>(state)]; }
};

/// Gets the number of a sample of stable gaze and its features, for the training.
using TakePursuit = std::function<void(std::size_t sample, const PursuitFeatureVector& features)>;

/// Labels samples while they arrive. A first step tells stable gaze, a moving eye, and an eye that
/// is gone (blink or data loss). Two second steps tell saccade from oscillation and fixation from
/// pursuit. Time per sample and memory do not grow.
class TrainedEvents {
 public:
  /// @param rate_Hz  nominal, > 0
  /// @param model    must live longer
  TrainedEvents(double rate_Hz, const EventSettings& settings, const EventModel& model);

  /// @param sight    the sample's direction, in the world if its head is known
  /// @param in_head  the same without the head
  /// @return the label of the sample that is `delaySamples()` older; nothing before there is one
  std::optional<SampleLabel> push(const GazeSample& sample, const TimedSight& sight,
                                  const std::optional<glm::dvec3>& in_head);
  /// The label of the oldest sample that has none, with the samples so far; for a recording's end.
  std::optional<SampleLabel> settleNext();

  std::size_t delaySamples() const { return delay_; }
  /// Standard deviation of a sample's error along each axis.
  double noise_deg() const { return features_.noise_deg(); }
  void onPursuit(TakePursuit take) { take_pursuit_ = std::move(take); }

 private:
  struct Pending {
    TimedSight sight{};
    bool blink = false;
    double step_s = 0.0;     ///< since the sample before
    double missing_s = 0.0;  ///< gaze is missing since so long, 0 if it is present
    std::array<double, 3> motion{};
    double oscillation = 0.0;
    ViterbiPath<3>::From from{};
  };

  void judgeNext();
  std::size_t motionOfOldest() const;
  SampleLabel settle();
  double pursuitOf(const Pending& pending);

  double rate_Hz_;
  EventSettings settings_;
  const ModelLevel* level_;  // of the model
  const ModelMode* mode_;
  std::size_t delay_ = 0, feature_delay_ = 0;
  GazeFeatures features_;
  std::deque<Pending> pending_{};  // without a label; the front is the oldest
  std::size_t judged_ = 0;         // of `pending_` have passed the first step
  std::size_t labelled_ = 0;       // samples before the front
  ViterbiPath<3> motion_path_;
  ViterbiPath<2> oscillation_path_, pursuit_path_;
  Motion motion_ = Motion::gone;  // of the newest label
  std::optional<double> newest_s_{}, last_present_s_{};
  DriftLine stable_{}, before_{}, before_that_{};
  std::deque<TimedSight> near_{};  // of `stable_`
  TakePursuit take_pursuit_{};
};

/// The labels of a complete recording.
/// @param take  may be empty
std::vector<SampleLabel> labelTrained(const GazeTrace& trace, const Screen& screen,
                                      const EventSettings& settings, const EventModel& model,
                                      const TakePursuit& take = {});

/// The labels of `TrainedEvents`, with the delay compensated.
std::vector<SampleLabel> labelTrainedOnline(const GazeTrace& trace, const Screen& screen,
                                            const EventSettings& settings, const EventModel& model,
                                            const TakePursuit& take = {});

}  // namespace foci
