// Screen geometry on disk: foci's TOML, or a PsychoPy monitor file.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "gaze/geometry/gaze_sample.h"

namespace foci {

struct ScreenCalibration {
  Screen screen;
  std::optional<double> gamma{};  ///< absent: sRGB as displayed
  std::string size_from;          ///< "bank card", "EDID", "by hand", ...
  std::string distance_from;      ///< "blind spot, 6 runs, 1 refused", "face size", "by hand", ...
};

/// The screen as commented TOML, every digit kept.
std::string screenToml(const ScreenCalibration& calibration);

/// Reads either format: a file that starts with `{` is a PsychoPy monitor.
/// @throws InputError by file and key
ScreenCalibration readScreen(const std::filesystem::path& file);

/// Reads a PsychoPy monitor file (`monitors/NAME.json`): `sizePix` [px, px], `width` cm, `distance`
/// cm. Of several named calibrations, the last in the alphabet counts, as in PsychoPy. The height
/// follows from square pixels. The gamma is the mean of the guns in `gammaGrid`, or else `gamma`; 1
/// is PsychoPy's default for an unmeasured screen.
/// @throws InputError where a field is missing, of the wrong type or out of range
ScreenCalibration readPsychoPyMonitor(const std::filesystem::path& file);

/// The screen as a PsychoPy monitor file with one calibration called `name`.
/// @param gamma  absent: PsychoPy's default
std::string psychoPyMonitor(const Screen& screen, std::optional<double> gamma,
                            const std::string& name);

}  // namespace foci
