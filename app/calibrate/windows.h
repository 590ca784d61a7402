// The windows of `foci calibrate`.
#pragma once

#include <functional>

#include "app/calibrate/options.h"
#include "calibration/camera/camera.h"
#include "calibration/gaze_map/gaze_report.h"
#include "calibration/screen/screen_file.h"
#include "calibration/webcam/webcam_calibration.h"

namespace foci {

struct GazeWindowResult {
  GazeReport report;
  std::optional<WebcamCalibration> webcam{};  ///< where that was the source
};

/// Targets, validation, result. Absent where the observer left.
/// @param screen  the monitor's size is taken from it, its pixels from the window
/// @param webcam  absent: the mouse is the tracker
/// @param camera  of the webcam; absent: a usual one
std::optional<GazeWindowResult> calibrateGazeInWindow(const CalibrateGazeOptions& options,
                                                      const Screen& screen,
                                                      const std::optional<WebcamPlace>& webcam,
                                                      const std::optional<Lens>& camera);

/// Card, distance, gamma. Absent where the observer left.
/// @param start  what is known already
std::optional<ScreenCalibration> calibrateScreenInWindow(const ScreenCalibration& start,
                                                         std::optional<glm::dvec2> edid_m,
                                                         bool window);

/// Fills an image, 8 bits, grey or BGR; false at the end.
using NextImage = std::function<bool(cv::Mat&)>;

/// The board's views as the observer shows it to a camera. Absent where the observer left.
/// @param size_px  of the images; set from them
std::optional<std::vector<BoardView>> watchBoardInWindow(const NextImage& next, const Board& board,
                                                         glm::ivec2& size_px);

}  // namespace foci
