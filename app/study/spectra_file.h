// Reads the spectra of a display's primaries.
#pragma once

#include <filesystem>
#include <vector>

#include "render/optics/colours.h"

namespace foci {

/// Reads a table with the columns wavelength (nm), red, green and blue, in this order, separated by
/// commas, semicolons, tabs or blanks; a heading and lines that begin with # are allowed. Powers
/// have any unit, the same for all.
/// @throws InputError naming file and line
std::vector<SpectrumSample> readSpectra(const std::filesystem::path& file);

}  // namespace foci
