// How far two frames are apart, in linear light.
#pragma once

#include "render/image/frame.h"

namespace foci {

/// Peak signal-to-noise ratio of RGB, -10 log10 of the mean squared difference (peak 1), dB;
/// infinite for equal frames. Both of the same size (asserted).
double psnr_dB(const Frame& a, const Frame& b);

}  // namespace foci
