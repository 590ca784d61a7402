// The windows of `foci calibrate`. Each function returns nullopt where the observer left.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "app/calibrate/options.h"
#include "calibration/camera/fit_camera.h"
#include "calibration/gaze_map/gaze_report.h"
#include "calibration/screen/screen_file.h"
#include "calibration/webcam/webcam_calibration.h"

namespace foci {

struct GazeWindowResult {
  GazeReport report;
  std::optional<WebcamCalibration> webcam{};  ///< present where a webcam was the source
};

/// Shows calibration targets, validation targets and the result.
/// @param screen  gives the size of a pixel and the distance; the window gives the resolution
/// @param webcam  absent: the mouse is the tracker
/// @param camera  of the webcam; absent: a camera of usual focal length without distortion
std::optional<GazeWindowResult> calibrateGazeInWindow(const CalibrateGazeOptions& options,
                                                      const Screen& screen,
                                                      const std::optional<WebcamPlace>& webcam,
                                                      const std::optional<Lens>& camera);

/// Measures the screen: bank card, distance, gamma.
/// @param start  measures from options or files; the window starts from them
/// @param edid_m  size that the display states
/// @param window  true: a window instead of the full screen
std::optional<ScreenCalibration> calibrateScreenInWindow(const ScreenCalibration& start,
                                                         std::optional<glm::dvec2> edid_m,
                                                         bool window);

/// Fills an image, 8 bits, grey or BGR; false at the end.
using NextImage = std::function<bool(cv::Mat&)>;

/// Collects views of the board while the observer shows it to a camera.
/// @param size_px  receives the size of the images
std::optional<std::vector<BoardView>> watchBoardInWindow(const NextImage& next, const Board& board,
                                                         glm::ivec2& size_px);

}  // namespace foci
