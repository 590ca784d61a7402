// Recordings as tables of text: TSV and CSV with a header line.
#pragma once

#include "gaze/geometry/gaze_sample.h"
#include "gaze/sources/line_reader.h"
#include "gaze/sources/trace_reader.h"

namespace foci {

/// Reads what `streamTrace` says of TSV and CSV.
/// @param header  the names of the columns where the file itself has none; else empty
/// @throws InputError
TraceHeader readDelimitedTrace(LineReader& lines, const TraceColumns& columns,
                               const Screen& fallback_screen, const TakeSample& take,
                               const std::string& header = {});

}  // namespace foci
