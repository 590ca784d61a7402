// Rows of a recording as samples: its columns get a meaning, and each row becomes a sample.
#pragma once

#include "gaze/sources/rows.h"
#include "gaze/sources/trace_reader.h"

namespace foci {

/// Reads rows as `streamTrace` describes. The screen of `rows.before()` stands in for what the
/// recording does not state.
/// @throws InputError
TraceHeader readRows(Rows& rows, const TraceColumns& columns, const TakeSample& take);

}  // namespace foci
