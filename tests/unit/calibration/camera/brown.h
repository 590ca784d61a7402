// The camera model of docs/calibration.md, written out as the reference of the tests.
#pragma once

#include "calibration/camera/camera.h"

namespace foci {

/// @param p_camera  a point of the camera frame, z > 0
inline glm::dvec2 projectByCamera(const CameraModel& camera, const glm::dvec3& p_camera) {
  const double x = p_camera.x / p_camera.z, y = p_camera.y / p_camera.z, r2 = x * x + y * y;
  const auto& [k1, k2, p1, p2, k3] = camera.distortion;
  const double radial = 1.0 + k1 * r2 + k2 * r2 * r2 + k3 * r2 * r2 * r2;
  const glm::dvec2 bent(x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
                        y * radial + 2.0 * p2 * x * y + p1 * (r2 + 2.0 * y * y));
  return camera.focal_px * bent + camera.principal_px;
}

}  // namespace foci
