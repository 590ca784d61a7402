// Linear light to the 8-bit code values of a display: IEC 61966-2-1.
#pragma once

#include <cstdint>
#include <vector>

#include "render/image/frame.h"

namespace foci {

/// One channel, both in [0, 1]; outside it the ends are taken. NaN gives 0.
float srgbFromLinear(float linear);
float linearFromSrgb(float srgb);

/// RGB bytes, row-major, 3 a pixel, each the nearest code value. Threads by TBB.
std::vector<std::uint8_t> srgb8(const Frame& frame);

}  // namespace foci
