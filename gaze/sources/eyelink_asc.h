// EyeLink ASC, the text format that edf2asc writes.
#pragma once

#include <string_view>

#include "gaze/geometry/gaze_sample.h"
#include "gaze/sources/line_reader.h"
#include "gaze/sources/trace_reader.h"

namespace foci {

/// Whether a file is an ASC. @param line  its first line that is not empty
bool startsEyeLinkAsc(std::string_view line);

/// Whether a line is a sample of an ASC: an integer time, numbers, and flags such as "..." or
/// ".C.".
bool isEyeLinkSample(std::string_view line);

/// Reads the samples of all recording blocks. They are passed on a good second late, because the
/// end of a blink decides whether it is one. The file gives the screen's size in pixels only, from
/// GAZE_COORDS or else DISPLAY_COORDS, and each block may have another. Points are on the first
/// one's pixels: all of them fill the same screen. Messages become markers and trials, after the
/// rules of Data Viewer (TRIALID, TRIAL_RESULT, !V TRIAL_VAR).
/// @param columns  only `missing`, `scale` and `offset` count
/// @throws InputError
TraceHeader readEyeLinkAsc(LineReader& lines, const TraceColumns& columns, const TakeSample& take);

}  // namespace foci
