// How well an eye sees: its depth of focus, its acuity, and what observers have on average.
#pragma once

#include <vector>

#include "app/eye/fourier_psf.h"

namespace foci {

/// The typical eye's pupil (`typicalWavefront`), rescaled and without refraction.
Pupil typicalPupil(double pupil_m);

/// Frequency at which focus is judged, cycles per degree, and the share of the best contrast there
/// that still counts as in focus. One criterion for all pupils: 80 % is what studies of image
/// quality use (Yi, Iskander and Collins, Journal of Vision 10(4), 2010).
inline constexpr double kFocus_cycles_per_deg = 10.0, kInFocusShare = 0.8;

/// Contrast at `kFocus_cycles_per_deg` in white light by defocus.
struct ThroughFocus {
  std::vector<double> defocus_D = {}, contrast = {};
};
/// @param reach_D  on both sides of 0
ThroughFocus throughFocus(const Pupil& pupil, double reach_D, double step_D);

/// The range of `throughFocus` for a pupil, dioptres on both sides of 0: the smaller, the deeper.
double focusReach_D(double pupil_m);

struct DepthOfFocus {
  double best_D = 0.0;                       ///< defocus of the largest contrast
  double nearest_D = 0.0, farthest_D = 0.0;  ///< where the contrast falls to `kInFocusShare`
  bool complete = true;  ///< false: the contrast stays above the limit to an end of the curve
  double total_D() const { return farthest_D - nearest_D; }
};
DepthOfFocus depthOfFocus(const ThroughFocus& through);

/// The finest grating that keeps 5 % of its contrast in white light, cycles per degree, and the
/// acuity log10(30 / u) that it stands for: a bar of the grating is a stroke of the letter.
struct GratingAcuity {
  double cycles_per_deg = 0.0;
  double logMAR() const;
};
GratingAcuity acuityOf(const EyeOptics& eye);

/// What a refraction leaves, standard deviation. Objective refractions of the eyes that Watson
/// averaged lie within 0.5 D of the subjective one in 95 % of eyes, with the best of 33 methods
/// (Thibos, Hong, Bradley and Applegate, Journal of Vision 4(4), 2004). A cylinder of as much has
/// the power vector of half its size.
inline constexpr double kRefractionLeft_D = 0.25, kCylinderLeft_D = 0.5 * kRefractionLeft_D;

/// Mean contrast at `cycles_per_deg`, in white light, of typical eyes behind the glasses of a
/// refraction: over normal errors of `kRefractionLeft_D` in the mean sphere and `kCylinderLeft_D`
/// in J0 and in J45. Quadrature of degree 5 in the sphere and 3 in the cylinder (Hermite).
double refractedContrast(double pupil_m, double cycles_per_deg);

/// Mean MTF of 200 eyes in white light (Watson, Journal of Vision 13(6), 2013):
///   M = (1 + (u / u1)^2)^-0.62 sqrt(D(u, d, 555 nm)),  u1 = 21.95 - 5.512 d + 0.3922 d^2.
/// @param pupil_mm  2 to 6
double meanMtf(double pupil_mm, double cycles_per_deg);

}  // namespace foci
