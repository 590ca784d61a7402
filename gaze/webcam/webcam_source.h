// Gaze by a webcam: `webcam[:N|FILE|PATTERN]`, live, or a video as a recording.
#pragma once

#include <functional>

#include "gaze/sources/live_source.h"
#include "gaze/webcam/webcam_frames.h"
#include "gaze/webcam/webcam_tracker.h"

namespace foci {

/// Where on the screen an observer seen so looks: a calibration's map.
struct WebcamGaze {
  glm::dvec2 point_px{0.0};
  double uncertainty_deg = 0.0;  ///< 68 % of the errors are smaller
};
using WebcamMapping = std::function<WebcamGaze(const WebcamView&)>;

struct WebcamFrame {
  double time_s = 0.0;  ///< of a file: after its first frame
  WebcamRecord record{};
};

/// @param map  absent: the sample has no point
GazeSample sampleOf(const WebcamFrame& frame, const WebcamMapping& map);

/// Every frame of a video or of images.
/// @throws InputError where they cannot be read, or have no frame
std::vector<WebcamFrame> readWebcam(const WebcamPlace& place, WebcamTracker& tracker);

class WebcamSource : public LiveSource {
 public:
  /// @param map  absent: not calibrated; records come, samples have no point, the status says so
  /// @throws InputError where there is no such camera or file
  WebcamSource(const WebcamPlace& place, WebcamTracker tracker, WebcamMapping map);

  void poll(double now_s, std::vector<GazeSample>& samples) override;
  double rate_Hz() const override { return frames_.rate_Hz(); }
  std::string status() const override;

  /// What the newest frames said, oldest first, since the last call: for calibrations.
  std::vector<WebcamFrame> takeFrames();

  /// The head that the frames are measured against; absent before the first face.
  std::optional<WebcamReference> reference() const { return tracker_.reference(); }

  /// No frame is left in the file.
  bool ended() const { return ended_; }

 private:
  WebcamPlace place_;
  WebcamFrames frames_;
  WebcamTracker tracker_;
  WebcamMapping map_;
  std::vector<WebcamFrame> recent_{};
  std::optional<double> first_s_{}, last_s_{};
  std::size_t count_ = 0;
  bool ended_ = false;
  bool face_ = false;
};

}  // namespace foci
