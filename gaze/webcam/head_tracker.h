// Follows a head from frame to frame. The tracker keeps views of the head and finds their patches
// in each frame (Lucas and Kanade 1981, with Bouguet's pyramids). Then it fits the pose of a rigid
// face to these patches. Poses do not drift, because each one is measured against a kept view and
// not against the previous frame.
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "gaze/webcam/head_pose.h"

namespace foci {

/// A view of a head with known pose.
struct HeadView {
  cv::Mat grey;               ///< 8 bits, a cut-out of the frame
  glm::dvec2 corner_px{0.0};  ///< the cut-out's top-left corner in the frame
  HeadPose pose;
};

class HeadTracker {
 public:
  explicit HeadTracker(const Pinhole& camera) : camera_(camera) {}

  /// Restarts from a frame in which the head has this pose.
  void start(const cv::Mat& grey, const HeadPose& pose);

  /// Restarts from a stored view. The first `follow` then needs a guess.
  void start(const HeadView& view);

  /// Finds the head in the next frame.
  /// @param guess  a pose close to the head's; absent: the latest pose
  /// @return nothing if the head is not found; the next call starts from the same pose again
  std::optional<HeadPoseFit> follow(const cv::Mat& grey,
                                    const std::optional<HeadPose>& guess = std::nullopt);

  bool started() const { return !views_.empty(); }
  /// The first view. All poses are measured against it, directly or through other views.
  const HeadView& firstView() const { return views_.front().view; }
  const HeadPose& pose() const { return pose_; }

  /// The pose of a head that faces the camera and has its irises at these points, of the
  /// observer's left and right eye.
  static HeadPose frontal(const Pinhole& camera, const std::array<glm::dvec2, 2>& irises_px);

 private:
  struct KeptView {
    HeadView view;
    std::vector<cv::Point2f> points_px;  // in the cut-out
    std::vector<glm::dvec3> points_mm;
    std::vector<double> weights;  // 1 / variance, 0 to 1
    std::vector<cv::Mat> pyramid;
  };
  void keep(HeadView view);
  void keep(const cv::Mat& grey, const HeadPose& pose);
  std::size_t nearestView(const HeadPose& pose) const;

  Pinhole camera_;
  std::vector<KeptView> views_;
  HeadPose pose_{};
};

/// Depth of the iris in the head frame, mm: the limbus of an eyeball of 12 mm radius that looks
/// ahead.
inline constexpr double kIrisDepth_mm = -10.5;

}  // namespace foci
