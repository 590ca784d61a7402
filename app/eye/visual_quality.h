// How well an eye sees: its depth of focus, its acuity, and what observers have on average.
// The eye's image of a point of light by Fourier optics (Goodman, Introduction to Fourier Optics,
// 3rd edition, 2005, chapter 6). It shares nothing with the renderer but the wavefront, and is what
// tests hold splatted images against.
#pragma once

#include <initializer_list>
#include <numbers>
#include <span>
#include <vector>

#include "render/optics/pupil.h"
#include "render/optics/wavefront.h"

namespace foci {

inline constexpr double kArcmin_rad = std::numbers::pi / 180.0 / 60.0;

/// An eye that looks at one point of light.
struct EyeOptics {
  Pupil pupil;             ///< diffraction_px and offset_m are not used
  double defocus_D = 0.0;  ///< focus less the vergence of the point
  double wavelength_m = 555e-9;
  double pupil_aspect = 1.0;  ///< width over height of an elliptical pupil as high as `pupil`
};

/// The largest angle of a ray of a point of light to that of a sharp eye, at these shares of the
/// pupil's radius and as many angles around it.
double steepest_rad(const EyeOptics& eye, int angles, std::initializer_list<double> shares);

/// Light by visual angle. Rows run downwards and columns to the right, as the observer sees them.
/// The direction of the point lies in the middle of the sample (size / 2, size / 2).
struct Psf {
  int size = 0;                    ///< samples along a side
  std::vector<double> light = {};  ///< row-major, of a total of 1
  double sample_rad = 0.0;

  double at(int column, int row) const {
    return light[static_cast<std::size_t>(row) * static_cast<std::size_t>(size) +
                 static_cast<std::size_t>(column)];
  }
};

///   PSF(t) = |sum over the pupil of a(x) exp(2 pi i / lambda (W(x) - t x))|^2,
/// W with the defocus (F - D) |x|^2 / 2, and a^2 the Stiles-Crawford sensitivity.
/// @param sample_rad  side of a sample, over which light is summed
/// @param size        samples along a side; light beyond them is lost
Psf fourierPsf(const EyeOptics& eye, double sample_rad, int size);

/// Contrast that a grating keeps, the mean of the OTF's modulus over all orientations.
std::vector<double> radialMtf(const EyeOptics& eye, std::span<const double> cycles_per_deg);

/// The same in white light of equal energy, as bright as V(lambda) makes it (CIE 1924), in 14 steps
/// of 20 nm. The eye focuses `wavelength_m`; the others are out of focus by
/// `chromaticDifference_D`.
std::vector<double> whiteMtf(const EyeOptics& eye, std::span<const double> cycles_per_deg);

/// Peak of the PSF over that of the same pupil without aberrations and defocus.
double strehlRatio(const EyeOptics& eye);

/// MTF of a round pupil without aberrations, 2 / pi (acos s - s sqrt(1 - s^2)), s = u lambda / A.
double diffractionMtf(double pupil_m, double wavelength_m, double cycles_per_deg);

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

/// Angles beside the line of sight that the schematic eye was compared with people for, degrees.
inline constexpr double kMostField_deg = 60.0;

/// What the schematic eye has for a point beside the line of sight.
struct FieldOfEye {
  /// Its wavefront less that on the axis: orders 2 to 4 by least squares on the slopes of rays that
  /// leave the eye from one point of the retina. Axes and signs are those of `Wavefront`, in the
  /// plane across the direction of the point, and the circle around the pupil.
  Wavefront added;
  double pupil_aspect = 1.0;  ///< width over height of the pupil that the point sees
};

/// @param field_deg  to the right of the line of sight; below 0: to the left
FieldOfEye fieldOfEye(double field_deg, double pupil_m);

}  // namespace foci
