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

/// Commented TOML, every digit kept.
std::string cameraToml(const CameraModel& camera);

/// @throws InputError by file and key
CameraModel readCamera(const std::filesystem::path& file);

}  // namespace foci
