// Screens as PsychoPy keeps them.
#pragma once

#include <filesystem>

#include "gaze/gaze.h"

namespace foci {

/// Reads a PsychoPy monitor file (`monitors/NAME.json`): `sizePix` [px, px], `width` cm, `distance`
/// cm. It keeps calibrations by name; the last in the file's order, PsychoPy's own choice, is
/// taken. The height follows from square pixels.
/// @throws InputError where a field is missing, of the wrong type or out of range
Screen readPsychoPyMonitor(const std::filesystem::path& file);

}  // namespace foci
