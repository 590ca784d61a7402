// Typical aberrations, for an eye that was not measured.
#pragma once

#include "render/optics/wavefront.h"

namespace foci {

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
