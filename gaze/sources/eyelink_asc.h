// EyeLink ASC, the text format that edf2asc writes.
#pragma once

#include <string_view>

#include "gaze/geometry/gaze_sample.h"
#include "gaze/sources/line_reader.h"
#include "gaze/sources/trace_reader.h"

namespace foci {

/// Whether a file is an ASC. @param line  its first line that is not empty
bool startsEyeLinkAsc(std::string_view line);

/// Reads the samples of all recording blocks. They are passed on a good second late, because the
/// end of a blink decides whether it is one. The file gives the screen's size in pixels only, from
/// GAZE_COORDS or else DISPLAY_COORDS.
/// @param columns  only `missing`, `scale` and `offset` count
/// @throws InputError
TraceHeader readEyeLinkAsc(LineReader& lines, const TraceColumns& columns, const TakeSample& take);

}  // namespace foci
