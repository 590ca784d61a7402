// The eye's own optics besides its focus: the refraction that glasses correct, and how far its foci
// for different colours lie apart.
#pragma once

#include <glm/glm.hpp>

namespace foci {

/// A spectacle prescription, the power in dioptres that corrects the eye, in either form of the
/// cylinder: sphere_D along the axis, sphere_D + cylinder_D across it. The vertex distance (glasses
/// to eye) is neglected, which errs by 0.012 P^2: 0.05 D at 2 D, 0.3 D at 5 D.
struct Prescription {
  double sphere_D = 0.0;
  double cylinder_D = 0.0;
  /// As ISO 8429 and opticians have it (TABO): from the horizontal, counter-clockwise as seen by
  /// somebody who faces the eye; the same for both eyes. On the screen that the eye looks at it is
  /// clockwise.
  double axis_deg = 0.0;
};

/// What the eye sees unblurred without glasses and without accommodation: F = -P, the power vector
/// of `Defocus` in image axes (Long, 1976; Thibos, Wheeler and Horner, 1997).
///   P = sphere I + cylinder n n',  n = (-sin axis, cos axis) across the axis
///   mean of F = -(sphere + cylinder / 2),  (J0, J45) of F = cylinder / 2 (cos 2 axis, sin 2 axis)
/// The image's y runs downwards, and the observer sees the axis mirrored: the two cancel.
struct Refraction {
  double far_point_D = 0.0;  ///< mean over all meridians: where the eye at rest is in focus; below
                             ///< 0 (long-sighted) behind the eye
  glm::vec2 astigmatism_D{0.0f};
};
Refraction refractionOf(const Prescription& prescription);

/// How much more the eye refracts light of a wavelength than of 580 nm, dioptres:
///   0.63346 / (lambda_um - 0.2141) - 1.7312        (Thibos, Ye, Zhang and Bradley, 1992)
/// Blue is in focus nearer. @param wavelength_um  0.38 to 0.78
double chromaticDifference_D(double wavelength_um);

/// That of a display's red, green and blue, each taken for light of its dominant wavelength: 611.4,
/// 549.1 and 464.2 nm of sRGB's primaries.
glm::vec3 chromaticDifferenceOfPrimaries_D();

}  // namespace foci
