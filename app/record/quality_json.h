// The quality of a recording in summaries.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "gaze/events/recording_quality.h"

namespace foci {

nlohmann::ordered_json toJson(const RecordingQuality& quality);

/// One line.
std::string qualityText(const RecordingQuality& quality);

}  // namespace foci
