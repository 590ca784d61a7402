// Recordings as text tables: TSV and CSV with a header line.
#pragma once

#include "gaze/geometry/gaze_sample.h"
#include "gaze/sources/line_reader.h"
#include "gaze/sources/trace_reader.h"

namespace foci {

/// Reads a table as `streamTrace` describes.
/// @param header  the columns' names if the file itself has none; else empty
/// @throws InputError
TraceHeader readDelimitedTrace(LineReader& lines, const TraceColumns& columns,
                               const Screen& fallback_screen, const TakeSample& take,
                               const std::string& header = {});

}  // namespace foci
