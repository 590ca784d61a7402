// Gaze from a webcam, live or from a video: `webcam[:N|FILE|PATTERN]`. A tracker gives one record
// of the observer's features for each frame, and a calibration maps the features to gaze.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <variant>

#include "gaze/live/live_source.h"
#include "gaze/webcam/cascade_tracker.h"
#include "gaze/webcam/network_tracker.h"
#include "gaze/webcam/webcam_frames.h"

namespace foci {

/// Removes the distortion of a lens from frames, so that straight lines are straight.
class StraightFrames {
 public:
  explicit StraightFrames(const Lens& lens) : lens_(lens) {}

  /// Resamples the frame (linearly) as a pinhole camera with the lens' focal length would show it.
  /// Returns the frame itself if the lens has no distortion. Valid until the next call.
  /// @param frame  8 bits, one channel
  /// @throws InputError if the frame has another size than the lens was calibrated for
  const cv::Mat& of(const cv::Mat& frame);

 private:
  Lens lens_;
  cv::Mat from_, weights_;  // tables of cv::remap
  cv::Mat straight_;
};

/// Networks follow the face where their models are installed, else cascades.
class WebcamTracker {
 public:
  /// @param camera     absent: the reference's camera, else a usual webcam
  /// @param reference  of a calibration; absent: the first face becomes the reference
  /// @throws InputError if the reference is of the other tracker, if a model is damaged, or if
  ///   neither models nor cascades are installed
  explicit WebcamTracker(const std::optional<Lens>& camera = std::nullopt,
                         const std::optional<WebcamReference>& reference = std::nullopt);

  /// @param image  8 bits, one channel or BGR; all of one size, in the order of time
  /// @throws InputError if the frame has another size than the camera was calibrated for
  WebcamRecord push(const cv::Mat& image);

  /// Absent before the first face.
  std::optional<WebcamReference> reference() const;

  /// Absent before the first frame, unless a calibration names it.
  const std::optional<Lens>& camera() const { return camera_; }
  bool byNetworks() const { return by_networks_; }

  /// For the user, who reads it once; empty with networks.
  std::string remark() const;

 private:
  std::optional<Lens> camera_;
  std::optional<WebcamReference> given_;
  std::optional<FaceNetworks> networks_;  // until the first frame
  bool by_networks_;
  std::optional<StraightFrames> straight_{};
  std::optional<std::variant<CascadeTracker, NetworkTracker>> tracker_{};  // from the first frame
};

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
