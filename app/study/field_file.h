// Reads the aberrations of eyes over the visual field.
#pragma once

#include <filesystem>

#include "render/optics/eye_field.h"

namespace foci {

/// Reads a table of right eyes, plain or packed by gzip, and fits it (`fitField`). A heading names
/// the columns, which tabs, commas or semicolons separate: `horizontal_deg` and `vertical_deg` in
/// the visual field (above 0: temporal, superior), `z3_um` to `z8_um` (OSA, for a pupil of 4 mm),
/// and `subject`, where the table has several eyes. Other columns are ignored.
/// @throws InputError naming file and line
FieldAberrations readFieldAberrations(const std::filesystem::path& file);

}  // namespace foci
