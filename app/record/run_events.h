// The gaze events of a run.
#pragma once

#include <string>
#include <vector>

#include "app/study/study.h"
#include "gaze/events/gaze_events.h"
#include "gaze/events/recording_quality.h"
#include "gaze/geometry/gaze_sample.h"

namespace foci {

struct RunEvents {
  /// That begin or end within the run, on the study's screen.
  std::vector<GazeEvent> events{};
  std::vector<GazeState> states{};      ///< of every sample of the recording
  RecordingQuality quality{};           ///< of the recording
  std::vector<std::string> warnings{};  ///< `eventWarnings`
};

/// The events within [from_s, to_s).
/// @param trace  with its screen
RunEvents eventsOfRun(const Study& study, const GazeTrace& trace, double from_s, double to_s);

std::size_t countOf(const std::vector<GazeEvent>& events, GazeState kind);

}  // namespace foci
