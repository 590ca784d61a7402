// From a webcam's frames to features of the observer: one record for each frame.
#pragma once

#include <optional>
#include <string>
#include <variant>

#include "gaze/webcam/cascade_tracker.h"
#include "gaze/webcam/network_tracker.h"

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

}  // namespace foci
