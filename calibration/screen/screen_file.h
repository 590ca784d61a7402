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

}  // namespace foci
