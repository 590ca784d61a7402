// Native recordings of Tobii Pro Glasses 2 (livedata.json.gz) and 3 (gazedata.gz).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "gaze/sources/rows.h"

namespace foci {

/// "Tobii Pro Glasses 2" or 3, if a file begins with such a line; else nothing.
std::optional<std::string> tobiiGlassesOf(std::string_view first_line);

/// Both eyes' centres, directions and pupils, in the columns of Pro Lab's export. Each line is a
/// JSON object. Glasses 2 write `ts` in microseconds, `s` (0: valid), the number of the sample
/// `gidx`, and one of `pc`, `pd`, `gd` for each `eye`. Glasses 3 write a sample in a line. Lengths
/// are in millimetres, x left, y up, z forward. Lines of other sensors are skipped.
/// @throws InputError for a line before the last that is no JSON
NumberRows readTobiiGlasses(LineReader& lines);

}  // namespace foci
