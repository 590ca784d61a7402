// The error that glasses correct, and the colours of light that the eye focuses differently.
#pragma once

#include <glm/glm.hpp>
#include <vector>

namespace foci {

/// Light of one wavelength, or of one primary.
struct Colour {
  float nearer_D = 0.0f;  ///< how much nearer than the focus this light is in focus
  glm::vec3 share{0.0f};  ///< of all light of the display's red, green and blue
  bool operator==(const Colour&) const = default;
};

/// The primaries, each as light of its dominant wavelength (`chromaticDifferenceOfPrimaries_D`).
std::vector<Colour> coloursOfPrimaries();

/// Luminous efficiency V(lambda) of CIE 1924, linear between its values each 10 nm; 0 outside of
/// 380 to 720 nm.
double luminousEfficiency(double wavelength_nm);

/// The light of a display's primaries at one wavelength, in any unit of power.
struct SpectrumSample {
  double wavelength_nm = 0.0;
  glm::dvec3 red_green_blue{0.0};
};

/// The spectra in `n` bands of equal width, each as light of the wavelength in its middle, weighted
/// by `luminousEfficiency`. The shares of each primary sum to 1. Bands without light are left out.
/// @param spectra  by wavelength, at least two; each primary has light that is seen (asserted)
std::vector<Colour> coloursOfSpectra(const std::vector<SpectrumSample>& spectra, int n);

/// A spectacle prescription: the power in dioptres that corrects the eye, sphere_D along the axis
/// and sphere_D + cylinder_D across it. Both signs of the cylinder are allowed. The vertex distance
/// (glasses to eye) is neglected. The error is 0.012 P^2: 0.05 D at 2 D, 0.3 D at 5 D.
struct Prescription {
  double sphere_D = 0.0;
  double cylinder_D = 0.0;
  /// Axis by ISO 8429 (TABO), as opticians write it: from the horizontal, counter-clockwise for
  /// somebody who faces the eye, the same for both eyes. On the screen before the eye it runs
  /// clockwise.
  double axis_deg = 0.0;
};

/// The focus of the eye without glasses and without accommodation: F = -P, as the power vector of
/// `Defocus` in image axes (Long, 1976; Thibos, Wheeler and Horner, 1997). The prescription is the
/// matrix
///   P = sphere I + cylinder n n',  with n = (-sin axis, cos axis) across the axis.
/// The mean of F is -(sphere + cylinder / 2), and
///   (J0, J45) of F = cylinder / 2 (cos 2 axis, sin 2 axis).
/// The image's y axis runs downwards and the observer sees the axis mirrored; the two cancel.
struct Refraction {
  /// Focus of the eye at rest, the mean over all meridians; below 0 (long-sighted) behind the eye.
  double far_point_D = 0.0;
  glm::vec2 astigmatism_D{0.0f};
};
Refraction refractionOf(const Prescription& prescription);

/// Refraction of the eye at a wavelength, less that at 580 nm, dioptres:
///   0.63346 / (lambda_um - 0.2141) - 1.7312        (Thibos, Ye, Zhang and Bradley, 1992)
/// Blue is in focus nearer.
/// @param wavelength_um  0.38 to 0.78
double chromaticDifference_D(double wavelength_um);

/// `chromaticDifference_D` of a display's red, green and blue. Each counts as light of its dominant
/// wavelength: 611.4, 549.1 and 464.2 nm for sRGB's primaries.
glm::vec3 chromaticDifferenceOfPrimaries_D();

}  // namespace foci
