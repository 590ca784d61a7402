// Frames of a real lens as a pinhole would have seen them: straight lines are straight.
#pragma once

#include <array>
#include <opencv2/core.hpp>

#include "gaze/webcam/head_pose.h"

namespace foci {

/// A calibrated camera.
struct Lens : Pinhole {
  /// Brown's k1, k2, p1, p2, k3 (OpenCV's order).
  std::array<double, 5> distortion{};
  glm::ivec2 size_px{0, 0};  ///< of the frames that it holds for; 0: any

  bool operator==(const Lens& other) const {
    return focal_px == other.focal_px && principal_px == other.principal_px &&
           distortion == other.distortion && size_px == other.size_px;
  }
};

class StraightFrames {
 public:
  explicit StraightFrames(const Lens& lens) : lens_(lens) {}

  /// The frame resampled (linearly) for the lens's own pinhole, or itself where the lens does not
  /// distort. Valid until the next call.
  /// @param frame  8 bits, one channel
  /// @throws InputError on a frame of another size than the lens's
  const cv::Mat& of(const cv::Mat& frame);

 private:
  Lens lens_;
  cv::Mat from_, weights_, straight_;  // remap's tables
};

}  // namespace foci
