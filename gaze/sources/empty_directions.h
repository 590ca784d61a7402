// Pupil Core's exports have columns of directions in space also where gaze was mapped in two
// dimensions. The columns are then empty, and the positions are the gaze.
#pragma once

#include <string_view>

#include "gaze/sources/table_layout.h"

namespace foci {

/// Leaves out the columns of origins and directions if `row` has no direction of either eye. Their
/// readings become "unused". Does nothing without columns of positions.
/// @param row  the first one: Pupil Core maps a whole recording in one way
void leaveOutEmptyDirections(TableLayout& layout, std::string_view row);

}  // namespace foci
