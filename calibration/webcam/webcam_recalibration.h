// Corrects a webcam's map during use: observers look at the point on which they click.
#pragma once

#include <chrono>
#include <mutex>
#include <optional>
#include <vector>

#include "calibration/webcam/webcam_map.h"
#include "gaze/geometry/gaze_sample.h"
#include "gaze/webcam/webcam_source.h"

namespace foci {

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
