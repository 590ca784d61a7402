// A calibrated screen on disk: our TOML, or a PsychoPy monitor.
#pragma once

#include <filesystem>
#include <string>

#include "gaze/geometry/gaze_sample.h"

namespace foci {

struct ScreenCalibration {
  Screen screen;
  std::optional<double> gamma{};  ///< absent: sRGB as displayed
  std::string size_from;          ///< "bank card", "EDID", "by hand", ...
  std::string distance_from;      ///< "blind spot, 6 runs, 1 refused", "face size", "by hand", ...
};

std::string screenToml(const ScreenCalibration& calibration);

/// Reads either kind, told apart by the first character that is not blank.
/// @throws InputError by file and key
ScreenCalibration readScreen(const std::filesystem::path& file);

}  // namespace foci
