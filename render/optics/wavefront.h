// The eye's wavefront error as Zernike coefficients, and its slope and curvature over the pupil;
// and the error of a typical eye. Order, signs and units follow OSA and ANSI Z80.28 (Thibos,
// Applegate, Schwiegerling and Webb, Standards for Reporting the Optical Aberrations of Eyes,
// Journal of Refractive Surgery 18, 2002).
#pragma once

#include <glm/glm.hpp>
#include <vector>

namespace foci {

/// Radial order n and angular frequency m of a Zernike polynomial, |m| <= n, n - m even.
struct ZernikeOrder {
  int n = 0, m = 0;
};

/// The single index j = (n (n + 2) + m) / 2, from 0 (piston), and its inverse.
int zernikeIndex(const ZernikeOrder& order);
ZernikeOrder zernikeOrder(int index);

/// Number of polynomials up to radial order `n`: (n + 1) (n + 2) / 2.
inline int zernikeCount(int n) { return (n + 1) * (n + 2) / 2; }

/// The highest radial order that foci takes: 66 coefficients.
inline constexpr int kMaxZernikeOrder = 10;

/// Value of the polynomial at a point of the unit disc, x to the right and y up. Its mean square
/// over the disc is 1.
double zernike(const ZernikeOrder& order, const glm::dvec2& at);

/// Error of the wavefront that leaves the eye, ahead of the reference sphere where positive:
///   W(x, y) = sum over j of zernike_um[j] Z_j(x / r, y / r),   r = pupil_m / 2.
/// x runs to the right and y up for somebody who faces the eye. So a short-sighted eye has a
/// positive coefficient 4 (defocus): an eye that is E dioptres too strong has E r^2 / (4 sqrt 3).
/// Piston and tilt (0 to 2) have no effect: the gaze says where the eye points.
struct Wavefront {
  std::vector<double> zernike_um = {};  ///< by single index; missing ones are 0
  double pupil_m = 0.0;                 ///< diameter of the pupil that they hold for
  bool operator==(const Wavefront&) const = default;

  /// False: an eye without aberrations, or none that the model sees.
  explicit operator bool() const;
};

/// The coefficients for the concentric part of the pupil with the diameter `pupil_m` (Dai, Optics
/// Letters 31, 2006; Schwiegerling, JOSA A 19, 2002):
///   b_nm = k^n sum_i a_(n+2i)m sqrt((n + 2i + 1)(n + 1))
///          sum_j (-1)^(i+j) (n+i+j)! / ((n+j+1)! (i-j)! j!) k^2j,   k = pupil_m / w.pupil_m.
/// @param pupil_m  above 0. A pupil larger than the measured one extrapolates.
Wavefront rescaled(const Wavefront& w, double pupil_m);

/// The second order as a power vector (M, J0, J45), dioptres: how much stronger than ideal the eye
/// is, M = 4 sqrt(3) c_4 / r^2, J0 = 2 sqrt(6) c_5 / r^2, J45 = 2 sqrt(6) c_3 / r^2. A prescription
/// that corrects the eye has the opposite signs (Thibos, Hong, Bradley and Applegate, 2004).
glm::dvec3 power_D(const Wavefront& w);
Wavefront withPower(Wavefront w, const glm::dvec3& power_D);

/// The same eye without the orders 0 to 2: what glasses do not correct.
Wavefront withoutRefraction(Wavefront w);

/// Root mean square over the pupil of the orders `lowest` and up, micrometres.
double rms_um(const Wavefront& w, int lowest = 2);

/// A wavefront as a polynomial in the axes of the image that the eye sees: x to the right and y
/// down for the observer. Both axes are opposite to the aberrometer's, W_image(p) = W(-p).
///
/// The eye focused at F dioptres sees a point at D dioptres from the lens point p displaced by
///   (A/2) f (F - D) p + f slope(p)   px,   A: pupil, f: focal length of the image, px,
/// the transverse ray aberration. The curvature is a matrix of dioptres that adds to the focus F.
class PupilWavefront {
 public:
  explicit PupilWavefront(const Wavefront& w);

  struct At {
    double error_m = 0.0;
    glm::dvec2 slope{0.0};        ///< rad
    glm::dmat2 curvature_D{0.0};  ///< symmetric
  };
  /// @param p  on the unit disc
  At at(const glm::dvec2& p) const;

 private:
  double radius_m_;
  int order_ = 0;
  std::vector<double> coefficient_m_;  ///< of x^a y^b, at b + (a+b)(a+b+1)/2
};

/// Age at which `typicalWavefront` has the root mean square of Salmon and van de Pol: taken as the
/// mean of their adults, which they do not state.
inline constexpr double kTypicalAge_years = 40.0;

/// Coma, trefoil and spherical aberration in the proportions of 2560 normal eyes, 0.14, 0.11 and
/// 0.13 um, with their mean higher-order root mean square of 0.33 um, at a pupil of 6 mm (Salmon
/// and van de Pol, Journal of Cataract and Refractive Surgery 32, 2006). The root mean square at 5
/// mm grows by 0.0032 um a year (Berrio, Tabernero and Artal, Journal of Vision 10(14), 2010). Both
/// eyes are alike, since coma and trefoil are vertical. No eye is typical: coefficients differ in
/// sign and size, and half of all eyes are better.
/// @param age_years  18 to 90
Wavefront typicalWavefront(double age_years = kTypicalAge_years);

}  // namespace foci
