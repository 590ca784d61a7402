// EyeLink's ASC, as edf2asc writes it.
#pragma once

#include <string_view>

#include "gaze/geometry/gaze_sample.h"
#include "gaze/sources/line_reader.h"
#include "gaze/sources/trace_reader.h"

namespace foci {

/// Whether a file whose first line that is not empty is `line` is an ASC.
bool startsEyeLinkAsc(std::string_view line);

/// Samples of all recording blocks, held back for a second or so, since only then a blink is known
/// to be one. Of its screen the file knows pixels only, from GAZE_COORDS or else DISPLAY_COORDS.
/// @throws InputError
TraceHeader readEyeLinkAsc(LineReader& lines, const TakeSample& take);

}  // namespace foci
