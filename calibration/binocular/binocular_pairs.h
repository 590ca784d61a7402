// Tables of samples for a binocular calibration.
#pragma once

#include <filesystem>
#include <vector>

#include "calibration/binocular/binocular.h"

namespace foci {

/// Reads `left_origin_x_mm left_origin_y_mm left_origin_z_mm left_direction_x left_direction_y
/// left_direction_z`, the same with `right_`, and `x_target_mm y_target_mm`.
/// - Eye centres and directions (of any length) are in the tracker's frame.
/// - Targets are on the display, from its centre, x right, y up.
/// - A header row names the columns, in any order; other columns are ignored. Tabs, commas,
///   semicolons or blanks separate them.
/// - An eye with an absent field (`n/a`, `nan`, `.`, nothing) is data loss. The columns of one eye
///   may be missing altogether.
/// @throws InputError by file and line
std::vector<BinocularSample> readBinocularPairs(const std::filesystem::path& file);

}  // namespace foci
