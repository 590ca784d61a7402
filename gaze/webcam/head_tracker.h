// Follows a head from frame to frame: patches of the face, as views kept of it show them, are found
// again (Lucas and Kanade 1981, Bouguet's pyramids), and the pose that puts a rigid face there is
// fitted. Each pose is measured against a kept view, not against the frame before: it does not
// drift.
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "gaze/webcam/head_pose.h"

namespace foci {

/// A view of a head whose pose is known.
struct HeadView {
  cv::Mat grey;               ///< 8 bits, a cut-out of the frame
  glm::dvec2 corner_px{0.0};  ///< of the cut-out, in the frame
  HeadPose pose;
};

class HeadTracker {
 public:
  explicit HeadTracker(const Pinhole& camera) : camera_(camera) {}

  /// Forgets what it knew. The head is taken to face the camera, rolled as the eyes lie.
  /// @param irises_px  of the observer's left and right eye
  void start(const cv::Mat& grey, const std::array<glm::dvec2, 2>& irises_px);

  /// Starts from a view kept from another time; `follow` wants a guess then.
  void start(const HeadView& view);

  /// @param guess  where the head is, if not where it was
  /// @return nothing where the head is lost; the next call tries the same again
  std::optional<HeadPoseFit> follow(const cv::Mat& grey,
                                    const std::optional<HeadPose>& guess = std::nullopt);

  bool started() const { return !views_.empty(); }
  /// The first view, against which all poses are measured in the end.
  const HeadView& firstView() const { return views_.front().view; }
  const HeadPose& pose() const { return pose_; }

  /// The pose of a head that faces the camera with irises there.
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

/// Depth of the iris in the head frame, mm: the limbus of an eye of 12 mm that looks ahead.
inline constexpr double kIrisDepth_mm = -10.5;

}  // namespace foci
