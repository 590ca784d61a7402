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
///
/// An astigmatic lens has a focus in each meridian: in image axes (x right, y down) the matrix
///   F = focus_D I + [J0 J45; J45 -J0]
/// (a power vector: Thibos, Wheeler and Horner, Optometry and Vision Science 74(6), 1997). A point
/// is seen from the lens point p, on the unit disc, moved by diag(radius_px_per_D) (F - I/U) p: the
/// disc becomes an ellipse of confusion, and a line where one of F's eigenvalues is 1/U.
struct Defocus {
  glm::vec2 radius_px_per_D{0.0f};  ///< along x and y; 0: a pinhole
  float focus_D = 0.0f;             ///< of an astigmatic lens the mean of all meridians
  DistanceAlong along = DistanceAlong::sight;
  glm::vec2 astigmatism_D{0.0f};  ///< (J0, J45); 0: a round lens
  /// How much nearer than that the red, green and blue primaries are in focus. `Method::render`
  /// renders each by itself where these are not all 0.
  glm::vec3 chromatic_D{0.0f};
  bool operator==(const Defocus&) const = default;
};

/// Variance of a uniform disc of radius 1 along an axis: that of what a point of light becomes.
inline constexpr float kDiscVariancePerRadius2 = 0.25f;

/// Variance of the Gaussian nearest (in L2) to a uniform disc of radius 1: a = 1 / (2 ln 4)  (Eq.
/// 11).
inline constexpr float kGaussianVariancePerRadius2 = 0.36067376f;

inline bool isAstigmatic(const Defocus& defocus) {
  return defocus.astigmatism_D != glm::vec2(0.0f);
}

/// Direction in the image, of length 1, in which an astigmatic lens focuses nearest: its focus is
/// focus_D + |astigmatism_D| there and focus_D - |astigmatism_D| across it.
glm::vec2 nearestMeridian(const Defocus& defocus);

/// Radius of the circle of confusion of a point `point_D` dioptres away (0: infinity). Pixels, >=
/// 0; exactly 0 in focus. Of an ellipse of confusion, half the sides of the box about it.
inline glm::vec2 blurRadius_px(const Defocus& defocus, float point_D) {
  const float off_D = point_D - defocus.focus_D;
  if (!isAstigmatic(defocus)) return defocus.radius_px_per_D * std::abs(off_D);
  const float j0 = defocus.astigmatism_D.x, j45 = defocus.astigmatism_D.y;
  return defocus.radius_px_per_D *
         glm::vec2(std::hypot(off_D - j0, j45), std::hypot(off_D + j0, j45));
}

/// Defocus in dioptres along the meridians where it is least and most, >= 0.
inline float leastDefocus_D(const Defocus& defocus, float point_D) {
  return std::abs(std::abs(point_D - defocus.focus_D) - glm::length(defocus.astigmatism_D));
}
inline float mostDefocus_D(const Defocus& defocus, float point_D) {
  return std::abs(point_D - defocus.focus_D) + glm::length(defocus.astigmatism_D);
}

/// Defocus of the round lens whose disc has the variance of the ellipse, the mean over all
/// meridians: sqrt(M^2 + J0^2 + J45^2), the blur strength of Thibos, Wheeler and Horner. Negative
/// where the point is farther than focus_D.
inline float roundDefocus_D(const Defocus& defocus, float point_D) {
  const float off_D = point_D - defocus.focus_D;
  if (!isAstigmatic(defocus)) return off_D;
  return std::copysign(std::hypot(off_D, glm::length(defocus.astigmatism_D)), off_D);
}

/// Eye behind a screen that its frustum agrees with: radius_px_per_D = (A/2) d_s R = (A/2)
/// focal_px. The camera of Eq. 3 comes to the same: (A/2) N H/(T - B) = (A/2) focal_px.
/// @param aperture_m  diameter of pupil or lens, >= 0
/// @param focus_D     below 0 where an eye without its glasses is in focus nowhere
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
