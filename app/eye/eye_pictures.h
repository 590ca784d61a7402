// Pictures of an eye: PSFs, its wavefront, and its curves.
#pragma once

#include <cstdint>
#include <vector>

#include "app/eye/eye_report.h"
#include "app/graphics/plot.h"

namespace foci {

/// The PSF in grey, brightest in white, with a bar of a round number of arcmin. Brightness is the
/// light to the power 1/2.2, so that faint light shows.
std::vector<std::uint8_t> psfPng(const Psf& psf, double* bar_arcmin);

/// The wavefront as who faces the eye sees it: warm where it is ahead, blue behind, white at 0; a
/// line each quarter of a micrometre.
std::vector<std::uint8_t> wavefrontPng(const Pupil& pupil, double* most_um);

Plot mtfPlot(const EyeFigures& eye);
/// White light, a curve for each field angle.
Plot fieldMtfPlot(const EyeFigures& eye);
Plot throughFocusPlot(const EyeFigures& eye);

}  // namespace foci
