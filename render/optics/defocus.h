// Circle of confusion of the thin lens: the paper's Eq. 1 to 4 (formulas.md, section 1).
#pragma once

#include <cmath>
#include <glm/glm.hpp>

namespace foci {

/// What U and P are measured along.
enum class DistanceAlong {
  sight,  ///< from the eye, along the line of sight to the point (the eye)
  axis,   ///< depth along the optical axis (a camera)
};

/// All that a renderer needs to know of a lens:
///   C_px = radius_px_per_D |1/U - focus_D|        (Eq. 1 to 4 in dioptres; the retina distance
///   cancels)
/// finite for U = F, U -> inf and focus at infinity (focus_D = 0).
struct Defocus {
  glm::vec2 radius_px_per_D{0.0f};  ///< along x and y; 0: a pinhole
  float focus_D = 0.0f;             ///< >= 0
  DistanceAlong along = DistanceAlong::sight;
};

/// Variance of a uniform disc of radius 1 along an axis: that of what a point of light becomes.
inline constexpr float kDiscVariancePerRadius2 = 0.25f;

/// Variance of the Gaussian nearest (in L2) to a uniform disc of radius 1: a = 1 / (2 ln 4)  (Eq.
/// 11).
inline constexpr float kGaussianVariancePerRadius2 = 0.36067376f;

/// Radius of the circle of confusion of a point `point_D` dioptres away (0: infinity). Pixels, >=
/// 0; exactly 0 in focus.
inline glm::vec2 blurRadius_px(const Defocus& defocus, float point_D) {
  return defocus.radius_px_per_D * std::abs(point_D - defocus.focus_D);
}

/// Eye behind a screen that its frustum agrees with: radius_px_per_D = (A/2) d_s R = (A/2)
/// focal_px. The camera of Eq. 3 comes to the same: (A/2) N H/(T - B) = (A/2) focal_px.
/// @param aperture_m  diameter of pupil or lens, >= 0
Defocus defocusOfLens(double aperture_m, const glm::vec2& focal_px, double focus_D,
                      DistanceAlong along);

/// Thin lens: distance behind the lens at which a point `object_m` away is sharp,
/// V = F U / (U - F)  (Eq. 1). Singular at U = F (returns infinity).
double imageDistance_m(double focal_length_m, double object_m);

/// Radius on the image plane, C = (A/2) |V_U - V_P| / V_U  (Eq. 2). The paper's own form: use
/// `retinalRadius_m` or `Defocus`, which are finite where this is not.
double circleOfConfusion_m(double aperture_m, double focal_length_m, double point_m,
                           double focus_m);

/// Radius on the retina, C = (A/2) V_P |1/U - 1/P|.
/// @param retina_m  lens to retina, 0.024 for the eye
double retinalRadius_m(double aperture_m, double retina_m, double point_D, double focus_D);

/// Angular diameter of the blur seen, A |1/U - 1/P|: 3.4377 arcmin a mm and dioptre. Radians.
double blurAngle_rad(double aperture_m, double point_D, double focus_D);

}  // namespace foci
