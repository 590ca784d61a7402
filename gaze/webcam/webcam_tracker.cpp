#include "gaze/webcam/webcam_tracker.h"

#include <algorithm>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

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

WebcamTracker::WebcamTracker(const std::optional<Lens>& camera,
                             const std::optional<WebcamReference>& reference)
    : camera_(camera),
      given_(reference),
      networks_(FaceNetworks::load()),
      by_networks_(networks_.has_value()) {
  if (!reference) return;
  if (!camera) camera_ = reference->camera;
  if (by_networks_ == reference->by_networks) return;
  throw InputError("webcam",
                   by_networks_
                       ? "the map was calibrated without the networks that follow the face now: "
                         "calibrate again (foci calibrate gaze)"
                       : "the map was calibrated with networks that are not installed here: get "
                         "them (sh app/webcam_models.sh), or calibrate again");
}

std::optional<WebcamReference> WebcamTracker::reference() const {
  if (!tracker_) return std::nullopt;
  return std::visit([](const auto& tracker) { return tracker.reference(); }, *tracker_);
}

std::string WebcamTracker::remark() const {
  if (by_networks_) return "";
  return "the webcam's networks are not installed (sh app/webcam_models.sh gets them): a simpler "
         "tracker serves, which needs good light and a first frame that looks straight ahead";
}

WebcamRecord WebcamTracker::push(const cv::Mat& image) {
  if (!tracker_) {
    const glm::ivec2 size_px(image.cols, image.rows);
    if (!camera_) camera_ = Lens{usualPinhole(size_px), {}, size_px};
    straight_.emplace(*camera_);
    if (networks_) {
      tracker_.emplace(NetworkTracker(std::move(*networks_), *camera_, given_));
      networks_.reset();
    } else {
      tracker_.emplace(CascadeTracker(*camera_, given_));
    }
  }
  const cv::Mat& straight = straight_->of(image);
  cv::Mat wanted = straight;
  const int channels = by_networks_ ? 3 : 1;
  if (straight.channels() != channels) {
    cv::cvtColor(straight, wanted, channels == 1 ? cv::COLOR_BGR2GRAY : cv::COLOR_GRAY2BGR);
  }
  return std::visit([&](auto& tracker) { return tracker.push(wanted); }, *tracker_);
}

}  // namespace foci
