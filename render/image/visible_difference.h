// The visible difference of two frames, in just-noticeable differences (JND).
#pragma once

#include <vector>

#include "render/image/frame.h"

namespace foci {

/// Resolution of a 96 dpi screen 0.6 m away, for errors that are measured without a screen.
inline constexpr double kUsualPx_per_deg = 40.0;

/// CIE 1976 L*a*b* difference of each pixel, in JND of 2.3 (Mahy, Van Eycken and Oosterlinck 1994).
/// Before, both frames are blurred like an eye in focus, by a Gaussian of 0.5 arcmin standard
/// deviation: a grating of 40 cycles a degree keeps a tenth of its contrast. White is the
/// display's, and brighter light is clamped to it.
/// @param px_per_deg  resolution at the middle of the display; positive (asserted)
/// @return row-major, one for each pixel. Both frames have the same size (asserted).
std::vector<float> visibleDifference(const Frame& a, const Frame& b, double px_per_deg);

}  // namespace foci
