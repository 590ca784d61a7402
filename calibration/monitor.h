// Screens as PsychoPy keeps them.
#pragma once

#include <filesystem>
#include <string>

#include "gaze/gaze.h"

namespace foci {

/// Reads a PsychoPy monitor file (`monitors/NAME.json`): `sizePix` [px, px], `width` cm, `distance`
/// cm. It keeps calibrations by name; the last in the file's order, PsychoPy's own choice, is
/// taken. The height follows from square pixels.
/// @throws InputError where a field is missing, of the wrong type or out of range
Screen readPsychoPyMonitor(const std::filesystem::path& file);

/// The screen as such a file, with one calibration called `name`.
/// @param gamma  absent: PsychoPy's own default
std::string psychoPyMonitor(const Screen& screen, std::optional<double> gamma,
                            const std::string& name);

}  // namespace foci
