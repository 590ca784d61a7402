// Labels of a recording by any detector, and why a signal cannot be judged.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gaze/events/event_settings.h"
#include "gaze/events/gaze_events.h"
#include "gaze/events/signal_doubts.h"
#include "gaze/events/trained_events.h"
#include "gaze/geometry/gaze_sample.h"

namespace foci {

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

/// Where the rate changes, labelling begins anew (`rateStretchesOf`).
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

}  // namespace foci
