// Screen geometry in PsychoPy's monitor files.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "gaze/geometry/gaze_sample.h"

namespace foci {

struct PsychoPyMonitor {
  Screen screen;
  std::optional<double> gamma{};  ///< absent: not measured
};

/// Reads a PsychoPy monitor file (`monitors/NAME.json`): `sizePix` [px, px], `width` cm, `distance`
/// cm. Of several named calibrations, the last in the file counts, as in PsychoPy. The height
/// follows from square pixels. `gamma` counts where it is above 1 and at most 4; 1 is PsychoPy's
/// default for an unmeasured screen.
/// @throws InputError where a field is missing, of the wrong type or out of range
PsychoPyMonitor readPsychoPyMonitor(const std::filesystem::path& file);

/// The screen as a PsychoPy monitor file with one calibration called `name`.
/// @param gamma  absent: PsychoPy's default
std::string psychoPyMonitor(const Screen& screen, std::optional<double> gamma,
                            const std::string& name);

}  // namespace foci
