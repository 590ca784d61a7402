// Removes the distortion of a lens from frames, so that straight lines are straight.
#pragma once

#include <array>
#include <opencv2/core.hpp>

#include "gaze/webcam/head_pose.h"

namespace foci {

/// A calibrated camera.
struct Lens : Pinhole {
  /// Brown's k1, k2, p1, p2, k3 (OpenCV's order).
  std::array<double, 5> distortion{};
  glm::ivec2 size_px{0, 0};  ///< size of the calibrated frames; 0: any size

  bool operator==(const Lens& other) const {
    return focal_px == other.focal_px && principal_px == other.principal_px &&
           distortion == other.distortion && size_px == other.size_px;
  }
};

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

}  // namespace foci
