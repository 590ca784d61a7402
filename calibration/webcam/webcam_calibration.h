// A webcam's calibration: the map from features to the screen, and the observer's head that the
// features are measured against; how it is made, and its file.
#pragma once

#include <filesystem>

#include "calibration/camera/camera.h"
#include "calibration/gaze_map/gaze_report.h"
#include "calibration/webcam/webcam_map.h"
#include "gaze/webcam/webcam_source.h"

namespace foci {

struct WebcamCalibration {
  WebcamMap map;
  WebcamReference reference;
  glm::dvec2 screen_m{0.0};  ///< size of the screen that it was made on
};

/// A target and when it was there to be looked at.
struct ShownTarget {
  double onset_s = 0.0, duration_s = 0.0;
  glm::dvec2 target_deg{0.0};
};

/// Reads `onset_s duration_s x_target y_target`, degrees from the screen's centre: columns in any
/// order, named by a header row, separated by tabs, commas or spaces.
/// @throws InputError by file and line
std::vector<ShownTarget> readShownTargets(const std::filesystem::path& file);

/// The views while targets were there, without the time that it takes to look at one: half a
/// second, or half of its duration where that is less. Blinks are among them as losses.
struct WebcamPair {
  std::optional<WebcamView> view{};
  double time_s = 0.0;
  glm::dvec2 target_deg{0.0};
};
std::vector<WebcamPair> pairFrames(std::span<const WebcamFrame> frames,
                                   std::span<const ShownTarget> targets);

/// Fits the map and measures it, on `other` where there is any.
/// @param screen  with all of its quantities known
/// @throws InputError where a face was seen at fewer than 5 targets
GazeReport calibrateWebcam(std::span<const WebcamPair> pairs, std::span<const WebcamPair> other,
                           const Screen& screen, WebcamMap& map);

/// A calibrated camera as webcams are seen through.
Lens lensOf(const CameraModel& camera);

/// The map is of one screen, the reference of one camera.
/// @param camera  absent: not said
/// @throws InputError where the screen's width or height differs by over 1 %, or the camera is
///   another
void requireSame(const WebcamCalibration& calibration, const Screen& screen,
                 const std::optional<Lens>& camera);

/// Where an observer seen so looks on `screen`.
WebcamMapping mappingOf(const WebcamMap& map, const Screen& screen);

std::string webcamCalibrationToml(const WebcamCalibration& calibration);

/// @throws InputError by file and key
WebcamCalibration readWebcamCalibration(const std::filesystem::path& file);

}  // namespace foci
