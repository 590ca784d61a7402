// What the observer's pupil does to light besides defocus: aberrations, the Stiles-Crawford effect,
// diffraction; and the lens divided into sub-apertures (parts) that are each simple to render.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

#include "render/optics/acuity.h"
#include "render/optics/defocus.h"
#include "render/optics/view.h"
#include "render/optics/wavefront.h"

namespace foci {

/// Standard deviation, rad, of the Gaussian that has the Airy pattern's peak and light:
///   sqrt(2) / pi  lambda / A = 0.450 lambda / A.
double diffractionGaussian_rad(double pupil_m, double wavelength_m);

/// The share of a point's peak that diffraction takes, seen through a Gaussian of `blur_px`:
/// 1 less the mean of the MTF of a round pupil over the frequencies that the Gaussian keeps.
/// @param diffraction_px  `diffractionGaussian_rad` on the image
double peakLostToDiffraction(double diffraction_px, double blur_px);

/// Standard deviation, px, of the one Gaussian that takes as much of the peak through a pixel of
/// 1 px as diffraction does; 0 where it adds less than 3 % to the pixel's variance.
float diffractionThroughPixel_px(float diffraction_px);

/// Diffraction as a core and two halos. Light near the rim of the pupil spreads most, and across
/// the rim: the halos are lines along the radius. Core and halos from all sides of the rim take as
/// much of the peak as diffraction does, through a pixel and through a blur as wide as each halo.
/// The Airy pattern has no finite variance. Within a disc of 4 to 12 px, core and halos have its
/// second moment within 3 % for pixels of 1 arcmin and pupils of 2 to 6 mm.
struct DiffractionHalo {
  float core_px = 0.0f;               ///< standard deviation
  std::array<float, 2> halo_px{};     ///< standard deviations along the radius
  std::array<float, 2> halo_share{};  ///< of the light; 0: diffraction does not show

  float inHalos() const { return halo_share[0] + halo_share[1]; }

  /// Standard deviation of the core of a part of the pupil, px. Its variance is in proportion to
  /// the light that the part loses.
  /// @param lost  by the part, over what all parts lose in the mean
  float coreOfPart_px(double lost) const;
};
DiffractionHalo diffractionHalo(float diffraction_px);

/// The share of its light that a point of the pupil keeps in the core. Waves have contrast at a
/// frequency only from pairs of points of the pupil whose distance s goes with the frequency
/// (Goodman 2005, section 6.3). A point of the pupil contributes while both ends of s, of which it
/// is the middle, lie in the pupil. The core has what contributes through a blur as wide as the
/// near halo.
class LightInCore {
 public:
  LightInCore(float diffraction_px, const DiffractionHalo& halo);
  /// @param radius  distance from the middle of the unit disc of the lens
  double at(double radius) const;
  /// Over the whole pupil, what `at` leaves.
  double lost() const { return lost_; }

 private:
  static constexpr int kSteps = 256;
  double lost_ = 0.0;
  std::array<double, kSteps + 1> by_radius_{};
};

/// Directional sensitivity of the cones, per mm^2 of the pupil: light at r mm from the centre
/// counts 10^(-rho r^2), with rho at 550 nm (Berendschot, van de Kraats and van Norren, JOSA A 18,
/// 2001).
inline constexpr double kStilesCrawford_per_mm2 = 0.041;

/// Image axes (x right, y down) throughout.
struct Pupil {
  double diameter_m = 0.0;
  /// At this diameter; its second order adds to the focus and astigmatism of `Defocus`.
  Wavefront wavefront = {};
  double stiles_crawford_per_mm2 = 0.0;  ///< 0: light counts alike everywhere
  glm::dvec2 stiles_crawford_center_m{0.0};
  /// Of the pupil's centre from the achromatic axis. A colour focused E dioptres nearer
  /// appears displaced by f E offset_m px (transverse chromatic aberration; Thibos, Bradley, Still,
  /// Zhang and Howarth, Vision Research 30, 1990).
  glm::dvec2 offset_m{0.0};
  float diffraction_px = 0.0f;  ///< `diffractionGaussian_rad` on the image; 0: not shown

  /// Whether sub-apertures see different images, besides defocus.
  bool hasParts() const { return wavefront || stiles_crawford_per_mm2 > 0.0; }
  bool operator==(const Pupil&) const = default;
};

/// The wavefront in a pupil; a plane one if it has none.
PupilWavefront wavefrontIn(const Pupil& pupil);

/// A displacement of this root mean square along an axis adds 1/100 to the variance of the
/// prefilter and 0.5 % to its width. That is below the change of blur that an observer sees, about
/// a tenth (Watson and Ahumada, Blur clarified, Journal of Vision 11(5), 2011). Parts of 0.2 px,
/// each invisible, leave points of light 0.2 % of the peak farther from Fourier optics.
inline constexpr float kRest_px = 0.1f;

/// A round sub-aperture, and what it sees. Over a small one the slope of the wavefront is nearly
/// linear, s(p) = s0 + H (p - c). It is then a lens of its own, with the focus F + H, whose image
/// is displaced by a constant:
///   B p + f s(p) = (A/2) f (F + H - D) p + f (s0 - (A/2) H c).
/// Astigmatism of H that displaces by less than `kRest_px` within the part counts as rest: kernels
/// stay round, and cost what defocus costs.
struct LensPart {
  glm::vec2 centre{0.0f};  ///< on the unit disc of the lens
  float radius = 1.0f;     ///< over the lens's; 0: a point
  float weight = 1.0f;     ///< share of the light; the weights sum to 1
  glm::vec2 shift_px{0.0f};
  Defocus defocus = {};
  /// Root mean square over the part of what s0 and H leave of the displacement, along an axis.
  float rest_px = 0.0f;
  float diffraction_px = 0.0f;  ///< standard deviation of the Gaussian of diffraction
  float nonlinear_px = 0.0f;    ///< the share of `rest_px` that astigmatism would not take away
};

/// The lens in `n` compact parts. All parts together have the light, the mean and the variance of
/// the lens, and of the wavefront's slope over it. Computed once for each `n`: the cells of a dense
/// sampling of the disc nearest to `n` points, each of which is the mean of its cell (Lloyd, 1982).
/// Where diffraction shows, the parts have the light of its core, which is less near the rim
/// (`LightInCore`); their mean has yet to be spread into the halos
/// (render/methods/mean_of_parts.h).
/// @param n  1 to 256; 1 has no core and halos
std::vector<LensPart> lensParts(const Defocus& defocus, const Pupil& pupil, int n);

/// The lens in points of equal share.
std::vector<LensPart> lensPoints(const Defocus& defocus, const Pupil& pupil,
                                 const std::vector<glm::vec2>& points);

/// Radius of the disc that spreads light as far as the wavefront alone does, px: twice the root
/// mean square of the slopes along an axis.
float aberrationRadius_px(const Defocus& defocus, const Pupil& pupil);

/// For images that diffraction spreads once they are finished.
inline Pupil withoutDiffraction(Pupil pupil) {
  pupil.diffraction_px = 0.0f;
  return pupil;
}

/// The view that a part has.
View viewOfPart(View view, const LensPart& part);

/// The prefilter, widened by the diffraction of the whole pupil where it shows, or by that and the
/// rest of a part.
Acuity widened(const Acuity& acuity, const Pupil& pupil);
Acuity widened(const Acuity& acuity, const LensPart& part);

}  // namespace foci
