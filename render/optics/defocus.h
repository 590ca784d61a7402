// The circle of confusion of a thin lens, Eq. 1 to 4 of the paper (docs/formulas.md, section 1).
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <memory>

namespace foci {

class LensField;

/// The line along which the distances U (point) and P (focus) are measured.
enum class DistanceAlong {
  sight,  ///< from the eye, along the line of sight to the point (the eye)
  axis,   ///< depth along the optical axis (a camera)
};

/// The lens, as a renderer needs it. A point at the distance U has the blur radius
///
///   C_px = radius_px_per_D |1/U - focus_D|.    (Eq. 1 to 4 in dioptres; lens to retina cancels)
///
/// The radius is finite for U = F, for U -> inf and for a focus at infinity (focus_D = 0).
///
/// An astigmatic lens has a focus in each meridian. In image axes (x right, y down) the foci form
/// the matrix
///   F = focus_D I + [J0 J45; J45 -J0],
/// a power vector (Thibos, Wheeler and Horner, Optometry and Vision Science 74(6), 1997). From the
/// lens point p, on the unit disc, a point appears displaced by diag(radius_px_per_D) (F - I/U) p.
/// The disc becomes an ellipse of confusion, and a line if 1/U is an eigenvalue of F.
struct Defocus {
  glm::vec2 radius_px_per_D{0.0f};  ///< along x and y; 0: a pinhole
  float focus_D = 0.0f;             ///< for an astigmatic lens, the mean of all meridians
  DistanceAlong along = DistanceAlong::sight;
  glm::vec2 astigmatism_D{0.0f};  ///< (J0, J45); 0: a round lens
  /// What each direction adds (lens_field.h); null: nothing. Made for `radius_px_per_D`.
  std::shared_ptr<const LensField> field = nullptr;
  bool operator==(const Defocus&) const = default;
};

/// Variance along an axis of a uniform disc of radius 1, the image of a point of light.
inline constexpr float kDiscVariancePerRadius2 = 0.25f;

/// Variance of the Gaussian nearest (in L2) to a uniform disc of radius 1, a = 1 / (2 ln 4)
/// (Eq. 11).
inline constexpr float kGaussianVariancePerRadius2 = 0.36067376f;

/// The same in all directions.
inline bool isAstigmatic(const Defocus& defocus) {
  return defocus.astigmatism_D != glm::vec2(0.0f);
}

/// Unit direction in the image along which an astigmatic lens focuses nearest, at
/// focus_D + |astigmatism_D|. Across it the lens focuses at focus_D - |astigmatism_D|.
glm::vec2 nearestMeridian(const Defocus& defocus);

/// Blur radius along x and y of a point at the vergence `point_D` (0: infinity), pixels, >= 0;
/// exactly 0 in focus. For an ellipse of confusion, half the sides of its bounding box.
inline glm::vec2 blurRadius_px(const Defocus& defocus, float point_D) {
  const float off_D = point_D - defocus.focus_D;
  if (!isAstigmatic(defocus)) return defocus.radius_px_per_D * std::abs(off_D);
  const float j0 = defocus.astigmatism_D.x, j45 = defocus.astigmatism_D.y;
  return defocus.radius_px_per_D *
         glm::vec2(std::hypot(off_D - j0, j45), std::hypot(off_D + j0, j45));
}

/// Smallest and largest defocus over all meridians, dioptres, >= 0.
inline float minDefocus_D(const Defocus& defocus, float point_D) {
  return std::abs(std::abs(point_D - defocus.focus_D) - glm::length(defocus.astigmatism_D));
}
inline float maxDefocus_D(const Defocus& defocus, float point_D) {
  return std::abs(point_D - defocus.focus_D) + glm::length(defocus.astigmatism_D);
}

/// Defocus of the round lens whose disc has the ellipse's variance, averaged over all meridians:
/// sqrt(M^2 + J0^2 + J45^2), the blur strength of Thibos, Wheeler and Horner. Negative if the point
/// lies beyond the focus.
inline float roundDefocus_D(const Defocus& defocus, float point_D) {
  const float off_D = point_D - defocus.focus_D;
  if (!isAstigmatic(defocus)) return off_D;
  return std::copysign(std::hypot(off_D, glm::length(defocus.astigmatism_D)), off_D);
}

/// Defocus of an eye whose frustum is the screen's: radius_px_per_D = (A/2) d_s R = (A/2) focal_px.
/// The camera of Eq. 3 gives the same: (A/2) N H/(T - B) = (A/2) focal_px.
/// @param aperture_m  diameter of pupil or lens, >= 0
/// @param focus_D     below 0 if the eye, without glasses, is in focus nowhere
Defocus defocusOfLens(double aperture_m, const glm::vec2& focal_px, double focus_D,
                      DistanceAlong along);

/// Radius on the retina, C = (A/2) V_P |1/U - 1/P|.
/// @param retina_m  lens to retina, 0.024 for the eye
double retinalRadius_m(double aperture_m, double retina_m, double point_D, double focus_D);

/// Angular diameter of the blur, A |1/U - 1/P|, rad: 3.4377 arcmin for each mm and dioptre.
double blurAngle_rad(double aperture_m, double point_D, double focus_D);

}  // namespace foci
