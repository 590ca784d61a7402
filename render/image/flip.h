// FLIP: the difference that an observer sees when two images take turns on a display (Andersson,
// Nilsson, Akenine-Moeller, Oskarsson, Astrom and Fairchild, FLIP: A Difference Evaluator for
// Alternating Images, PACM CGIT 3(2), 2020), for images of standard dynamic range.
#pragma once

#include <vector>

#include "render/image/frame.h"

namespace foci {

/// @param px_per_deg  resolution at the middle of the display; positive (asserted)
/// @return row-major, one for each pixel: 0 (equal) to 1 (black against white is 0.97). Light above
/// 1 is clamped. Both frames have the same size (asserted).
std::vector<float> flipOf(const Frame& a, const Frame& b, double px_per_deg);

}  // namespace foci
