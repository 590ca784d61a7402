#include "gaze/webcam/straight_frames.h"

#include <algorithm>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "base/input_error.h"

namespace foci {

const cv::Mat& StraightFrames::of(const cv::Mat& frame) {
  const auto text = [](int x, int y) { return std::to_string(x) + "x" + std::to_string(y); };
  if (lens_.size_px.x > 0 && lens_.size_px != glm::ivec2(frame.cols, frame.rows)) {
    throw InputError("webcam", "frames of " + text(frame.cols, frame.rows) +
                                   " px: the camera was calibrated at " +
                                   text(lens_.size_px.x, lens_.size_px.y) + ", expected the same");
  }
  if (std::all_of(lens_.distortion.begin(), lens_.distortion.end(),
                  [](double k) { return k == 0.0; })) {
    return frame;
  }
  if (from_.empty()) {
    // OpenCV counts pixel centres from 0.
    const cv::Matx33d pinhole(lens_.focal_px.x, 0.0, lens_.principal_px.x - 0.5, 0.0,
                              lens_.focal_px.y, lens_.principal_px.y - 0.5, 0.0, 0.0, 1.0);
    const cv::Mat distortion(1, 5, CV_64F, lens_.distortion.data());
    cv::initUndistortRectifyMap(pinhole, distortion, cv::noArray(), pinhole, frame.size(), CV_16SC2,
                                from_, weights_);
  }
  cv::remap(frame, straight_, from_, weights_, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return straight_;
}

}  // namespace foci
