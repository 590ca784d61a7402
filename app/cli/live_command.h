// `foci live`: look at the scene and it follows your eye.
#pragma once

#include <string>

#include "app/live/options.h"

namespace foci {

/// One line for people, or JSON for programs.
std::string liveSummaryText(const LiveSummary& summary);
std::string liveSummaryJson(const LiveSummary& summary);

}  // namespace foci
