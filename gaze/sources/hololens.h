// HoloLens 2: `*_head_hand_eye.csv` of Microsoft's Stream Recorder (HoloLens2ForCV).
#pragma once

#include <string_view>

#include "gaze/sources/line_reader.h"
#include "gaze/sources/trace_reader.h"

namespace foci {

/// Whether a table without a header is one of Stream Recorder, by its 861 numbers a row.
bool isHoloLens(std::string_view first_line);

/// Reads the rows. A row has the time in 100 ns and the head's transform to the world (4 x 4, row
/// by row). For each hand a flag and 26 transforms follow. Then come a flag for gaze, its origin
/// and direction (4 numbers each), and its distance. The world is right-handed with y up, in
/// metres; gaze is in the world.
TraceHeader readHoloLens(LineReader& lines, const TraceColumns& columns, const TakeSample& take);

}  // namespace foci
