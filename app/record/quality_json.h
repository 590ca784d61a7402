// The quality of a recording in summaries, and what is doubtful about its events.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "gaze/events/event_labels.h"
#include "gaze/events/recording_quality.h"

namespace foci {

nlohmann::ordered_json toJson(const RecordingQuality& quality);

/// One line.
std::string qualityText(const RecordingQuality& quality);

/// Why stretches are `unjudged`, what lies outside of the training's range, and that turns of the
/// head look like pursuit. A sentence each.
std::vector<std::string> eventWarnings(const GazeTrace& trace, const EventLabels& labels,
                                       const RecordingQuality& quality,
                                       const EventSettings& settings);

}  // namespace foci
