// The trained detector: boosted trees on features of gaze, smoothed by hidden Markov models.
#pragma once

#include <array>
#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "gaze/events/event_model.h"
#include "gaze/events/event_settings.h"
#include "gaze/events/gaze_features.h"
#include "gaze/events/pursuit_features.h"
#include "gaze/events/viterbi.h"
#include "gaze/geometry/gaze_sample.h"

namespace foci {

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

  void judgeMotion(Pending& pending, std::size_t sample);
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
