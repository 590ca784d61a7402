// Where a head is and how it is turned, from points of a face whose shape is known roughly.
//
// The camera frame: x to the image's right, y down, z away from the camera. The head frame, mm:
// the origin between the eyeballs' centres; parallel to the camera's in a head that faces it
// upright.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <span>

namespace foci {

/// Focal length and principal point; pixel centres at +0.5.
struct Pinhole {
  glm::dvec2 focal_px{0.0};
  glm::dvec2 principal_px{0.0};
};

/// What a webcam has where nobody calibrated it: 60 degrees across.
Pinhole usualPinhole(const glm::ivec2& size_px);

/// Distance between the centres of the eyes, mm: adults have 63 +- 3.6 (Dodgson 2004). All lengths
/// are as right as this is for the observer.
inline constexpr double kBetweenEyes_mm = 63.0;

struct HeadPose {
  glm::dmat3 camera_from_head{1.0};
  glm::dvec3 position_mm{0.0, 0.0, 600.0};  ///< of the head's origin, camera frame
};

glm::dvec2 project(const Pinhole& camera, const HeadPose& pose, const glm::dvec3& p_head_mm);

/// z of an average face's surface: an ellipsoid with a nose. Absent beside it.
std::optional<double> faceDepth_mm(double x_mm, double y_mm);

/// Where the line of sight of a pixel meets the surface z = faceDepth(x, y). Head frame.
std::optional<glm::dvec3> onFace_mm(const Pinhole& camera, const HeadPose& pose,
                                    const glm::dvec2& point_px);

/// The same with the plane z = `z_mm` of the head frame.
glm::dvec3 onHeadPlane_mm(const Pinhole& camera, const HeadPose& pose, const glm::dvec2& point_px,
                          double z_mm);

struct HeadPoseFit {
  HeadPose pose;
  double inliers = 0.0;  ///< share of the points
  double rms_px = 0.0;   ///< of these
};

/// min sum rho(sqrt(w) |project(R X + t) - x|) by Gauss and Newton with Tukey's weights.
/// @param weights  w of each point, 0 to 1
/// @param start    near the pose
/// @return nothing with fewer than 6 points, or where they do not agree
std::optional<HeadPoseFit> fitHeadPose(const Pinhole& camera, std::span<const glm::dvec3> points_mm,
                                       std::span<const glm::dvec2> image_px,
                                       std::span<const double> weights, const HeadPose& start);

}  // namespace foci
