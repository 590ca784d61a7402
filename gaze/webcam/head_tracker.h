// Position and rotation of a head, from points on a face of average shape, and from frame to frame.
// The tracker keeps views of the head and finds their patches in each frame (Lucas and Kanade 1981,
// with Bouguet's pyramids). Then it fits the pose of a rigid face to these patches. Poses do not
// drift, because each one is measured against a kept view and not against the previous frame.
//
// The camera frame has x to the image's right, y down, and z away from the camera. The head frame,
// in millimetres, has its origin midway between the centres of the eyeballs. Its axes are parallel
// to the camera's if the head is upright and faces the camera.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <vector>

namespace foci {

/// Focal length and principal point; pixel centres at +0.5.
struct Pinhole {
  glm::dvec2 focal_px{0.0};
  glm::dvec2 principal_px{0.0};

  bool operator==(const Pinhole&) const = default;
};

/// A calibrated camera.
struct Lens : Pinhole {
  /// Brown's k1, k2, p1, p2, k3 (OpenCV's order).
  std::array<double, 5> distortion{};
  glm::ivec2 size_px{0, 0};  ///< size of the calibrated frames; 0: any size

  bool operator==(const Lens&) const = default;
};

/// The camera model of a usual webcam, for a camera without calibration: 60 degrees wide.
Pinhole usualPinhole(const glm::ivec2& size_px);

/// Mean interpupillary distance of adults, mm: 63 +- 3.6 (Dodgson 2004). It sets the scale of all
/// lengths, so they have the same relative error as this value has for the observer.
inline constexpr double kMeanIpd_mm = 63.0;

/// Gram-Schmidt orthonormalisation, so that rounding errors do not accumulate.
glm::dmat3 orthonormal(const glm::dmat3& m);

struct HeadPose {
  glm::dmat3 camera_from_head{1.0};
  glm::dvec3 position_mm{0.0, 0.0, 600.0};  ///< of the head's origin, camera frame
};

glm::dvec2 project(const Pinhole& camera, const HeadPose& pose, const glm::dvec3& p_head_mm);

/// z of the surface of an average face: an ellipsoid with a nose. Nothing beside the face.
std::optional<double> faceDepth_mm(double x_mm, double y_mm);

/// The point where a pixel's ray meets the surface z = faceDepth(x, y). Head frame.
std::optional<glm::dvec3> onFace_mm(const Pinhole& camera, const HeadPose& pose,
                                    const glm::dvec2& point_px);

/// The point where a pixel's ray meets the plane z = `z_mm`. Head frame.
glm::dvec3 onHeadPlane_mm(const Pinhole& camera, const HeadPose& pose, const glm::dvec2& point_px,
                          double z_mm);

/// The angle of the turn from one rotation to another.
double angleBetween_rad(const glm::dmat3& a, const glm::dmat3& b);

struct HeadPoseFit {
  HeadPose pose;
  double inliers = 0.0;  ///< share of the points that agree with the pose
  double rms_px = 0.0;   ///< reprojection error of the inliers
};

/// Minimises sum rho(sqrt(w) |project(R X + t) - x|) by Gauss-Newton steps with Tukey's weights.
/// @param weights  w of each point, 0 to 1
/// @param start    close to the pose
/// @return nothing with fewer than 6 points, or if no pose fits them
std::optional<HeadPoseFit> fitHeadPose(const Pinhole& camera, std::span<const glm::dvec3> points_mm,
                                       std::span<const glm::dvec2> image_px,
                                       std::span<const double> weights, const HeadPose& start);

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
