// The gaze events of a run.
#pragma once

#include <vector>

#include "app/study/study.h"
#include "gaze/events/gaze_events.h"
#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// Events that begin or end within [from_s, to_s), on the study's screen.
/// @param trace  with its screen
std::vector<GazeEvent> eventsOfRun(const Study& study, const GazeTrace& trace, double from_s,
                                   double to_s);

std::size_t countOf(const std::vector<GazeEvent>& events, GazeState kind);

}  // namespace foci
