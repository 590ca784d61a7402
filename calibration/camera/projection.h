// The projection of a camera model, for plain numbers and for Ceres' automatic derivatives.
// Private.
#pragma once

namespace foci {

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
