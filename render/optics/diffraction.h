// Diffraction at the pupil as Gaussians that have the peak of the Airy pattern as a pixel sees it.
#pragma once

#include <array>

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

}  // namespace foci
