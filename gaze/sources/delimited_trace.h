// Recordings as tables of text: TSV and CSV with a header line.
#pragma once

#include "gaze/gaze.h"
#include "gaze/sources/line_reader.h"
#include "gaze/sources/trace_reader.h"

namespace foci {

/// Reads what `readTrace` says of TSV and CSV; `GazeTrace::rate_Hz` is left to the caller.
/// `GazeTrace::screen` is complete if file and fallback together are.
/// @throws InputError
GazeTrace readDelimitedTrace(LineReader& lines, const TraceColumns& columns,
                             const Screen& fallback_screen);

}  // namespace foci
