// How far two frames are apart to the eye, in just noticeable differences.
#pragma once

#include <vector>

#include "render/image/frame.h"

namespace foci {

/// Of a screen of 96 dpi, 0.6 m away: what errors are measured at that are of no screen's own.
inline constexpr double kUsualPx_per_deg = 40.0;

/// CIE 1976 L*a*b* difference by pixel, in units of 2.3, the just noticeable one (Mahy, Van
/// Eycken and Oosterlinck 1994), after the eye's own blur: a Gaussian of 0.5 arcmin standard
/// deviation, which leaves a tenth of a grating's contrast at 40 cycles a degree. White is the
/// display's; light beyond it is held to it, as a display does.
/// @param px_per_deg  of the display as seen, in its middle; positive (asserted)
/// @return row-major, as many as pixels. Both frames are of one size (asserted).
std::vector<float> visibleDifference(const Frame& a, const Frame& b, double px_per_deg);

}  // namespace foci
