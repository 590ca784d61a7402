// What a binocular calibration is made from, as a table.
#pragma once

#include <filesystem>
#include <vector>

#include "calibration/binocular/binocular.h"

namespace foci {

/// Reads `left_origin_x_mm left_origin_y_mm left_origin_z_mm left_direction_x left_direction_y
/// left_direction_z`, the same with `right_`, and `x_target_mm y_target_mm`: eye centres and
/// directions (of any length) in the tracker's frame, targets on the display from its centre, x
/// right, y up. Columns in any order, named by a header row, separated by tabs, commas, semicolons
/// or blanks; other columns pass. An eye with any of its fields absent (`n/a`, `nan`, `.`, nothing)
/// was lost; the columns of one eye may be missing altogether.
/// @throws InputError by file and line
std::vector<BinocularSample> readBinocularPairs(const std::filesystem::path& file);

}  // namespace foci
