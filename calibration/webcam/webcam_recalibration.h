// A webcam's map that clicks keep right while it is used: who clicks on a thing looks at it.
#pragma once

#include <chrono>
#include <mutex>
#include <optional>
#include <vector>

#include "calibration/webcam/webcam_map.h"
#include "gaze/geometry/gaze_sample.h"
#include "gaze/webcam/webcam_source.h"

namespace foci {

/// For two threads: one asks for the gaze, the other clicks.
class WebcamRecalibration {
 public:
  WebcamRecalibration(const WebcamMap& map, const Screen& screen)
      : calibrated_(map), map_(map), screen_(screen) {}

  /// By the map as it is now.
  WebcamGaze gazeOf(const WebcamView& view);

  /// Fits the map again, to what it was calibrated with, faded, and to the clicks, of which the
  /// newest count (`fitWebcamMap`).
  /// @return false: no eyes were seen just now, nothing is changed
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
  std::vector<WebcamSample> clicks_;  // the newest last
};

}  // namespace foci
