// A captured scene of 3D Gaussians (Kerbl et al., 3D Gaussian Splatting for Real-Time Radiance
// Field Rendering, 2023): volumes that are composited front to back, not samples of surfaces.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <vector>

namespace foci {

struct GaussianTree;

/// A symmetric 3x3 matrix.
struct Covariance3 {
  float xx = 0.0f, xy = 0.0f, xz = 0.0f, yy = 0.0f, yz = 0.0f, zz = 0.0f;
  bool operator==(const Covariance3&) const = default;
};

inline glm::mat3 matrixOf(const Covariance3& v) {
  return {v.xx, v.xy, v.xz, v.xy, v.yy, v.yz, v.xz, v.yz, v.zz};
}
inline float traceOf(const Covariance3& v) { return v.xx + v.yy + v.zz; }

/// Largest degree of the spherical harmonics.
inline constexpr int kMaxHarmonicsDegree = 3;

/// Coefficients of the degrees 1 to `degree`, for one colour channel.
constexpr int harmonicsOf(int degree) { return (degree + 1) * (degree + 1) - 1; }

/// Coefficients of degree 1 and more are stored in steps of this size. The formats for sharing
/// store them in 8 bits, with steps 16 times as large or more.
inline constexpr float kHarmonicsStep = 1.0f / 4096.0f;

/// Smallest alpha of a Gaussian at a pixel: the rasteriser that scenes are trained with ends a
/// Gaussian where its alpha falls below (Kerbl et al. 2023).
inline constexpr float kMinAlpha = 1.0f / 255.0f;

/// Gaussians as a structure of arrays, all of the same length. The frame is that of the file: in
/// metres, right-handed, any axis up.
///
/// Gaussian k has the opacity `opacity exp(-d' V^-1 d / 2)` at the offset d from its position, V
/// its covariance. Its colour is a display value (sRGB), because captures are trained on images:
///
///   0.5 + sum over i of coefficient_i Y_i(direction from the eye), at least 0     (harmonics.h)
struct GaussianCloud {
  static constexpr const char* kNoun = "Gaussians";

  std::vector<glm::vec3> position_m;
  std::vector<Covariance3> covariance_m2;
  std::vector<float> opacity;    ///< 0 to 1
  std::vector<glm::vec3> color;  ///< display value of degree 0: 0.5 + coefficient_0 Y_0
  /// Of degree 1 and more: for each Gaussian all coefficients, red, green and blue of each in turn,
  /// in steps of kHarmonicsStep.
  std::vector<std::int16_t> harmonics;
  int degree = 0;  ///< of the harmonics, 0 to kMaxHarmonicsDegree
  /// Trained with a low-pass that preserves light (Yu et al., Mip-Splatting, 2024). If false, the
  /// low-pass of the renderer makes small Gaussians wider and not fainter (Kerbl et al. 2023).
  bool preserves_light = false;
  /// Its level of detail. The Gaussians are then in the tree's order. Null: not made yet.
  std::shared_ptr<const GaussianTree> tree = {};

  std::size_t size() const { return position_m.size(); }
  bool empty() const { return position_m.empty(); }
  /// Numbers in `harmonics` for one Gaussian.
  std::size_t harmonicsPerGaussian() const { return 3 * std::size_t(harmonicsOf(degree)); }
};

inline float opacityOf(const GaussianCloud& cloud, std::size_t i) { return cloud.opacity[i]; }

/// An upper bound of the standard deviation along any axis.
inline float largestSigma(const GaussianCloud& cloud, std::size_t i) {
  return std::sqrt(traceOf(cloud.covariance_m2[i]));
}

/// Covariance of a Gaussian with the standard deviations `sigma` along the axes of a rotation.
/// @param rotation  quaternion (x, y, z, w) of unit length
Covariance3 covarianceOf(const glm::vec3& sigma, const glm::vec4& rotation);

/// @param axes  perpendicular to each other, each a standard deviation long
Covariance3 covarianceOf(const glm::mat3& axes);

/// Adds Gaussians of the same degree. The tree stays as it is.
void append(GaussianCloud& to, const GaussianCloud& from);

/// The scene, with its tree, enlarged by `factor`, > 0.
void scaleBy(GaussianCloud& cloud, float factor);

/// Moves the scene: p becomes linear p + offset. Colours that depend on the direction turn with it.
/// The tree is dropped.
/// @param linear  invertible; it may mirror
void transform(GaussianCloud& cloud, const glm::mat3& linear, const glm::vec3& offset);

}  // namespace foci
