// Reads the tables that the study of an eye names: its wavefront, its aberrations over the visual
// field, and the spectra of the display that it sees.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "render/optics/colours.h"
#include "render/optics/eye_field.h"
#include "render/optics/wavefront.h"

namespace foci {

struct MeasuredEyes {
  std::optional<Wavefront> left, right;  ///< at least one
};

/// Cells of a line, without quotes. Inside brackets or quotes nothing separates: Z(2,-2).
std::vector<std::string> cellsOf(std::string_view line, char separator);

/// Reads a table of Zernike coefficients, separated by commas, semicolons, tabs or blanks:
/// one row a term, with the columns `n` and `m`, or the single index (`j`, `index`, `osa`) or a
/// name (`term`, `mode`), and the value (`um`, `nm`, `value`, `coefficient`, of the eye in the
/// column `eye` or of both; or `right` or `OD` and `left` or `OS`); or one row an eye, with a
/// column for each term (Z3, Z(2,-2), Z2-2) and the columns `eye` and `pupil_mm`. A row of two
/// cells may give the pupil, `pupil_mm, 6`, or the unit, `unit, nm`. Values are micrometres unless
/// a heading, a column `unit`, such a row or, beside none of these, a comment says nm. Terms that
/// are absent are 0.
/// @param pupil_mm  diameter that the coefficients hold for, where the file names none
/// @throws InputError naming file and line
MeasuredEyes readWavefronts(const std::filesystem::path& file, std::optional<double> pupil_mm);

/// Reads a table of the aberrations of right eyes over the visual field, plain or packed by gzip,
/// and fits it (`fitField`). A heading names the columns, which tabs, commas or semicolons
/// separate: `horizontal_deg` and `vertical_deg` in the visual field (above 0: temporal, superior),
/// `z3_um` to `z8_um` (OSA, for a pupil of 4 mm), and `subject`, where the table has several eyes.
/// Other columns are ignored.
/// @throws InputError naming file and line
FieldAberrations readFieldAberrations(const std::filesystem::path& file);

/// Reads the spectra of a display's primaries: a table with the columns wavelength (nm), red, green
/// and blue, separated by commas, semicolons, tabs or blanks, and with a decimal comma beside
/// semicolons and tabs. A heading (red or r, ...) gives the order of the colours, which is else
/// that of their mean wavelengths; other lines above the numbers, and those that begin with #, are
/// allowed. Powers have any unit, the same for all.
/// @throws InputError naming file and line
std::vector<SpectrumSample> readSpectra(const std::filesystem::path& file);

}  // namespace foci
