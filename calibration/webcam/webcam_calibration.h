// A webcam's calibration: its fit, its file, and its correction during use. It holds the map from
// features to the screen and the reference view of the observer's head, against which the features
// are measured.
#pragma once

#include <chrono>
#include <filesystem>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calibration/camera/camera.h"
#include "calibration/gaze_map/gaze_report.h"
#include "calibration/webcam/webcam_map.h"
#include "gaze/geometry/gaze_sample.h"
#include "gaze/webcam/webcam_source.h"

namespace foci {

struct WebcamCalibration {
  WebcamMap map;
  WebcamReference reference;
  glm::dvec2 screen_m{0.0};  ///< size of the calibrated screen
};

/// A target and when it was on the screen.
struct ShownTarget {
  double onset_s = 0.0, duration_s = 0.0;
  glm::dvec2 target_deg{0.0};
  bool operator==(const ShownTarget&) const = default;
};

/// Reads `onset_s duration_s x_target y_target`, degrees from the screen's centre. A header row
/// names the columns, in any order; tabs, commas or spaces separate them.
/// @throws InputError by file and line
std::vector<ShownTarget> readShownTargets(const std::filesystem::path& file);

/// A view and the target that was on the screen.
struct WebcamPair {
  std::optional<WebcamView> view{};  ///< absent in a blink or without a face
  double time_s = 0.0;
  glm::dvec2 target_deg{0.0};
};

/// The frames while targets were on the screen. The first half second of each target is left out,
/// or half of a shorter target: the eye is still moving there.
std::vector<WebcamPair> pairFrames(std::span<const WebcamFrame> frames,
                                   std::span<const ShownTarget> targets);

/// Fits the map and measures its accuracy: on `other`, or on `pairs` where `other` is empty.
/// @param screen  with resolution, size and distance known
/// @throws InputError where eyes were in view at fewer than 5 targets
GazeReport calibrateWebcam(std::span<const WebcamPair> pairs, std::span<const WebcamPair> other,
                           const Screen& screen, WebcamMap& map);

/// A calibrated camera as the lens of a webcam.
Lens lensOf(const CameraModel& camera);

/// Requires the screen and the camera of the calibration.
/// @param camera  absent: the study names none
/// @throws InputError where the screen's width or height differs by more than 1 %, or where the
///   camera differs
void requireSame(const WebcamCalibration& calibration, const Screen& screen,
                 const std::optional<Lens>& camera);

/// The map as a function from a view to a pixel of `screen`.
WebcamMapping mappingOf(const WebcamMap& map, const Screen& screen);

/// Commented TOML, every digit kept; the view of the head is a PNG in base64.
std::string webcamCalibrationToml(const WebcamCalibration& calibration);

/// @throws InputError by file and key
WebcamCalibration readWebcamCalibration(const std::filesystem::path& file);

/// Safe for two threads: one asks for gaze, the other reports clicks.
class WebcamRecalibration {
 public:
  WebcamRecalibration(const WebcamMap& map, const Screen& screen)
      : calibrated_(map), map_(map), screen_(screen) {}

  /// Gaze by the current map.
  WebcamGaze gazeOf(const WebcamView& view);

  /// Fits the map again to the newest clicks, with the calibrated map as a faded prior
  /// (`fitWebcamMap`).
  /// @return false where no eyes were in view in the last 0.3 s; the map is then unchanged
  bool click(const glm::dvec2& point_px);

 private:
  struct Seen {
    WebcamView view;
    std::chrono::steady_clock::time_point at;
  };

  std::mutex mutex_;
  WebcamMap calibrated_, map_;
  Screen screen_;
  std::optional<Seen> seen_;
  std::vector<WebcamSample> clicks_;  // oldest first
};

}  // namespace foci
