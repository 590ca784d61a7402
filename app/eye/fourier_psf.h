// The eye's image of a point of light by Fourier optics (Goodman, Introduction to Fourier Optics,
// 3rd edition, 2005, chapter 6). It shares nothing with the renderer but the wavefront, and is what
// splatted images are held against.
#pragma once

#include <numbers>
#include <span>
#include <vector>

#include "render/optics/pupil.h"

namespace foci {

inline constexpr double kArcmin_rad = std::numbers::pi / 180.0 / 60.0;

/// An eye that looks at one point of light.
struct EyeOptics {
  Pupil pupil;             ///< diffraction_px and offset_m are not used
  double defocus_D = 0.0;  ///< focus less the vergence of the point
  double wavelength_m = 555e-9;
  double pupil_aspect = 1.0;  ///< width over height of an elliptical pupil as high as `pupil`
};

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

/// The same as seen through the pixels of foci: spread by the bell (1 - r^2 / (8 sigma^2))^2, of
/// the standard deviation `sigma_px` along each axis (docs/formulas.md, section 3), and taken at
/// the middles of pixels of `pixel_rad`.
Psf psfThroughPixels(const EyeOptics& eye, double pixel_rad, double sigma_px, int size);

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

}  // namespace foci
