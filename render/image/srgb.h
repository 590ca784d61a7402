// Linear light to the 8-bit code values of a display: IEC 61966-2-1, or a power.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "render/image/frame.h"

namespace foci {

/// One channel. Arguments are clamped to [0, 1]; NaN gives 0.
float srgbFromLinear(float linear);
float linearFromSrgb(float srgb);

/// RGB bytes, row-major, three for each pixel, each the nearest code value. Threads by TBB.
/// @param gamma  of a display that emits (code / 255)^gamma, 1 to 4; absent: sRGB
std::vector<std::uint8_t> codesOf(const Frame& frame, std::optional<double> gamma = std::nullopt);

/// Mean of Y = 0.2126 R + 0.7152 G + 0.0722 B over the frame, channels clamped to [0, 1]; 1 for a
/// white frame, 0 for an empty one.
double meanLuminance(const Frame& frame);

}  // namespace foci
