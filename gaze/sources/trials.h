// Trials of an experiment, from the messages of a recording.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// The first word of a message that begins a trial, after the rules of EyeLink's Data Viewer.
inline constexpr std::string_view kTrialMessage = "TRIALID";

/// A message that begins with `start` begins a trial, whose name is the rest of it, or all of it if
/// there is no rest. The trial ends with TRIAL_RESULT, with the next trial or at `end_s`; between,
/// `!V TRIAL_VAR name value` states a variable.
/// @param messages  in order of time
std::vector<TraceTrial> trialsIn(const std::vector<TraceMarker>& messages, std::string_view start,
                                 double end_s);

/// The trial at a time, of several the one that began last; null between trials.
/// @param trials  in order of their beginnings
const TraceTrial* trialDuring(const std::vector<TraceTrial>& trials, double time_s);

/// Its name as a field of a table; "n/a" between trials.
std::string trialAt(const std::vector<TraceTrial>& trials, double time_s);

}  // namespace foci
