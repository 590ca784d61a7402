// EyeLink's ASC, as edf2asc writes it.
#pragma once

#include <string_view>

#include "gaze/gaze.h"
#include "gaze/sources/line_reader.h"

namespace foci {

/// Whether a file whose first line that is not empty is `line` is an ASC.
bool startsEyeLinkAsc(std::string_view line);

/// Samples of all recording blocks. Of its screen the file knows pixels only, from GAZE_COORDS or
/// else DISPLAY_COORDS; `GazeTrace::rate_Hz` is left to the caller.
/// @throws InputError
GazeTrace readEyeLinkAsc(LineReader& lines);

}  // namespace foci
