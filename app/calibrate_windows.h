// The windows of `foci calibrate`.
#pragma once

#include "app/calibrate_options.h"
#include "calibration/camera.h"
#include "calibration/gaze_report.h"
#include "calibration/screen_file.h"

namespace foci {

/// Targets, validation, result. Absent where the observer left.
/// @param screen  the monitor's size is taken from it, its pixels from the window
std::optional<GazeReport> calibrateGazeInWindow(const CalibrateGazeOptions& options,
                                                const Screen& screen);

/// Card, distance, gamma. Absent where the observer left.
/// @param start  what is known already
std::optional<ScreenCalibration> calibrateScreenInWindow(const ScreenCalibration& start,
                                                         std::optional<glm::dvec2> edid_m,
                                                         bool window);

}  // namespace foci
