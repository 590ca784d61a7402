// A calibrated camera: focal length, principal point and distortion (Brown 1966), and its file.
#pragma once

#include <array>
#include <filesystem>
#include <glm/glm.hpp>
#include <string>

namespace foci {

/// Pixels from a direction (x, y, 1) in the camera frame, y down, r^2 = x^2 + y^2:
///   radial = 1 + k1 r^2 + k2 r^4 + k3 r^6
///   x' = x radial + 2 p1 x y + p2 (r^2 + 2 x^2)
///   y' = y radial + 2 p2 x y + p1 (r^2 + 2 y^2)
///   px = focal (x', y') + principal
/// Pixel centres lie at +0.5.
struct CameraModel {
  glm::ivec2 size_px{0, 0};
  glm::dvec2 focal_px{0.0};
  glm::dvec2 principal_px{0.0};
  std::array<double, 5> distortion{};  ///< k1, k2, p1, p2, k3, OpenCV's order
  glm::dvec2 focal_sd_px{0.0};         ///< from the fit's covariance
  double rms_px = 0.0;                 ///< reprojection error
};

/// Projects a point of the camera frame, z > 0. Pixels.
glm::dvec2 projectByCamera(const CameraModel& camera, const glm::dvec3& p_camera);

/// Commented TOML, every digit kept.
std::string cameraToml(const CameraModel& camera);

/// @throws InputError by file and key
CameraModel readCamera(const std::filesystem::path& file);

inline constexpr int kCameraParameters = 9;  ///< fx fy cx cy k1 k2 p1 p2 k3

/// Pixels of the direction (x, y, 1), as `CameraModel` states it.
/// @param camera  `kCameraParameters` numbers
/// @param px  two numbers, the result
template <typename T>
void projectTo(const T* camera, const T& x, const T& y, T* px) {
  const T r2 = x * x + y * y;
  const T radial = T(1.0) + r2 * (camera[4] + r2 * (camera[5] + r2 * camera[8]));
  px[0] =
      camera[0] * (x * radial + T(2.0) * camera[6] * x * y + camera[7] * (r2 + T(2.0) * x * x)) +
      camera[2];
  px[1] =
      camera[1] * (y * radial + T(2.0) * camera[7] * x * y + camera[6] * (r2 + T(2.0) * y * y)) +
      camera[3];
}

}  // namespace foci
