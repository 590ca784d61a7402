// Reads the wavefront of the observer's eyes from the table of an aberrometer.
#pragma once

#include <filesystem>
#include <optional>

#include "render/optics/wavefront.h"

namespace foci {

struct MeasuredEyes {
  std::optional<Wavefront> left, right;  ///< at least one
};

/// Reads a table of Zernike coefficients, separated by commas, semicolons, tabs or blanks:
/// one row a term, with the columns `n` and `m`, or the single index (`j`, `index`, `osa`) or a
/// name (`term`, `mode`), and the value (`um`, `nm`, `value`, `coefficient`, of the eye in the
/// column `eye` or of both; or `right` or `OD` and `left` or `OS`); or one row an eye, with a
/// column for each term (Z3, Z(2,-2), Z2-2) and the columns `eye` and `pupil_mm`. A row of two
/// cells may give the pupil: `pupil_mm, 6`. Values are micrometres unless a heading says nm. Terms
/// that are absent are 0.
/// @param pupil_mm  diameter that the coefficients hold for, where the file names none
/// @throws InputError naming file and line
MeasuredEyes readWavefronts(const std::filesystem::path& file, std::optional<double> pupil_mm);

}  // namespace foci
