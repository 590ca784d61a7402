// Gaze from a webcam, live or from a video: `webcam[:N|FILE|PATTERN]`.
#pragma once

#include <functional>

#include "gaze/live/live_source.h"
#include "gaze/webcam/webcam_frames.h"
#include "gaze/webcam/webcam_tracker.h"

namespace foci {

/// A calibration's estimate of gaze.
struct WebcamGaze {
  glm::dvec2 point_px{0.0};
  double uncertainty_deg = 0.0;  ///< 68 % of the errors are smaller
};
/// Maps the features of a frame to gaze.
using WebcamMapping = std::function<WebcamGaze(const WebcamView&)>;

struct WebcamFrame {
  double time_s = 0.0;  ///< in a file: since the first frame
  WebcamRecord record{};
};

/// @param map  absent: the sample has no point
GazeSample sampleOf(const WebcamFrame& frame, const WebcamMapping& map);

struct WebcamRecording {
  std::vector<WebcamFrame> frames;
  /// What stands in the way of good gaze, a sentence each: `WebcamTracker::remark`,
  /// `WebcamFrames::remark`, and in how many frames there was which problem.
  std::vector<std::string> warnings;
};

/// Reads every frame of a video or of images.
/// @throws InputError if the file cannot be read or has no frame
WebcamRecording readWebcam(const WebcamPlace& place, WebcamTracker& tracker);

class WebcamSource : public LiveSource {
 public:
  /// @param map  absent: not calibrated. Then the samples have no point, and the status says so.
  /// @throws InputError if there is no such camera or file
  WebcamSource(const WebcamPlace& place, WebcamTracker tracker, WebcamMapping map);

  void poll(double now_s, std::vector<GazeSample>& samples) override;
  double rate_Hz() const override { return frames_.rate_Hz(); }
  std::string status() const override;

  /// The frames since the last call, oldest first. Calibrations use them.
  std::vector<WebcamFrame> takeFrames();

  /// `WebcamTracker::remark`.
  std::string remark() const { return tracker_.remark(); }

  /// The reference head of the features; absent before the first face.
  std::optional<WebcamReference> reference() const { return tracker_.reference(); }

  /// True after the last frame of a file.
  bool ended() const { return ended_; }

 private:
  WebcamPlace place_;
  WebcamFrames frames_;
  WebcamTracker tracker_;
  WebcamMapping map_;
  std::vector<WebcamFrame> recent_{};
  std::optional<double> first_s_{}, last_s_{};
  bool ended_ = false;
  std::string problem_ = textOf(WebcamProblem::no_face, 0.0);
};

}  // namespace foci
