// Screens as PsychoPy keeps them.
#pragma once

#include <filesystem>
#include <string>

#include "gaze/geometry/gaze_sample.h"

namespace foci {

struct PsychoPyMonitor {
  Screen screen;
  std::optional<double> gamma{};  ///< absent: not measured
};

/// Reads a PsychoPy monitor file (`monitors/NAME.json`): `sizePix` [px, px], `width` cm, `distance`
/// cm. It keeps calibrations by name; the last in the file's order, PsychoPy's own choice, is
/// taken. The height follows from square pixels. `gamma` is taken where it is a number above 1 (1
/// is PsychoPy's own default for a screen that nobody measured) and up to 4.
/// @throws InputError where a field is missing, of the wrong type or out of range
PsychoPyMonitor readPsychoPyMonitor(const std::filesystem::path& file);

/// The screen as such a file, with one calibration called `name`.
/// @param gamma  absent: PsychoPy's own default
std::string psychoPyMonitor(const Screen& screen, std::optional<double> gamma,
                            const std::string& name);

}  // namespace foci
