// Rows of a recording as samples: its columns get a meaning, and each row becomes a sample.
#pragma once

#include "gaze/sources/rows.h"
#include "gaze/sources/table_layout.h"
#include "gaze/sources/trace_reader.h"

namespace foci {

/// What the recording states of the screen; the rest from the fallback.
Screen screenInForce(Screen screen, const Screen& fallback);

/// Reads rows as `streamTrace` describes.
/// @param fallback_screen  for what `rows.before()` does not state
/// @throws InputError; SeveralPeople
TraceHeader readRows(Rows& rows, const TraceColumns& columns, const Screen& fallback_screen,
                     const TakeSample& take);

}  // namespace foci
