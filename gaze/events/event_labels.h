// Labels of a recording by any detector, why a signal cannot be judged, and how two labellings
// agree.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "gaze/events/event_settings.h"
#include "gaze/events/gaze_events.h"
#include "gaze/events/trained_events.h"
#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// Why a sample cannot be judged.
enum class SignalDoubt {
  none,
  slow,   ///< the rate is below 25 Hz: a fixation may hold a saccade
  lost,   ///< more than half of the second around it is lost
  white,  ///< white noise that is wider than saccades: it explains the changes of position
  frozen  ///< the position does not change in any digit for a second
};

/// Time with each doubt; `none` stays 0.
using DoubtTimes = std::array<double, 5>;

/// The doubt about each sample. Data loss for longer than `max_blink_s` is no doubt, because it is
/// labelled `lost`.
/// @param ahead_s  how far a later sample may be that is used: `kWholeRecording` for all
std::vector<SignalDoubt> signalDoubts(const GazeTrace& trace, const Screen& screen,
                                      const EventSettings& settings, double ahead_s);
inline constexpr double kWholeRecording = 1e9;

/// A sentence for each reason, with the time that it concerns. `rules` labels such stretches all
/// the same.
std::vector<std::string> doubtWarnings(const DoubtTimes& unjudged_s, Detector detector);

/// Changes if labels change: "1", for `trained` that of its model.
std::string versionOf(Detector detector);

/// Name and version, for reports: "trained 1".
std::string labelOf(Detector detector);

struct EventLabels {
  std::vector<GazeState> states{};  ///< one for each sample
  /// Of every state, as `SampleLabel`; empty unless the detector is `trained`.
  std::vector<std::array<double, kGazeStates>> probabilities{};
  DoubtTimes unjudged_s{};
  std::vector<std::string> warnings{};  ///< why stretches are `unjudged`, a sentence each
  /// False: every sample is `unjudged` or `lost`. Online labels too are judged in hindsight here.
  bool any_judged = false;
};

/// The state of every sample. Offline, each decision may use the complete recording. Where the rate
/// changes, labelling begins anew (`rateStretchesOf`).
/// @param trace   its rate must be known
/// @param screen  the screen of the samples, with known size and distance
/// @param online  the labels of `OnlineEvents`, with the delay compensated
EventLabels labelEvents(const GazeTrace& trace, const Screen& screen,
                        const EventSettings& settings = {}, bool online = false);

/// The events of the labels, with their probabilities.
std::vector<GazeEvent> eventsOf(const EventLabels& labels, const GazeTrace& trace,
                                const Screen& screen, const EventSettings& settings);

/// `EventSettings::pursuit` for this recording, if the study does not state it.
bool judgesPursuit(const GazeTrace& trace, const EventSettings& settings);

/// Cohen's kappa (1960) of two yes-or-no labellings: (p_o - p_e) / (1 - p_e), with the observed
/// agreement p_o and the agreement p_e that chance alone would give.
class CohensKappa {
 public:
  void add(bool a, bool b) {
    count_ += 1.0;
    a_ += a;
    b_ += b;
    both_ += a && b;
  }

  /// 1 for full agreement, 0 for the agreement of chance. Nothing if both labellings are constant
  /// and equal, because chance alone would agree then.
  std::optional<double> value() const {
    const double chance =
        (a_ * b_ + (count_ - a_) * (count_ - b_)) / std::max(count_ * count_, 1.0);
    if (count_ == 0.0 || chance >= 1.0) return std::nullopt;
    return ((count_ - a_ - b_ + 2.0 * both_) / count_ - chance) / (1.0 - chance);
  }

 private:
  double count_ = 0.0, a_ = 0.0, b_ = 0.0, both_ = 0.0;
};

}  // namespace foci
