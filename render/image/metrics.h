// Differences of two frames in linear light. The frames have the same size (asserted), the peak
// is 1.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "render/image/frame.h"
#include "render/optics/defocus.h"

namespace foci {

/// Peak signal-to-noise ratio of RGB, -10 log10 of the mean squared difference, dB; infinite for
/// equal frames.
double psnr_dB(const Frame& a, const Frame& b);

/// Structural similarity (Wang, Bovik, Sheikh and Simoncelli 2004), mean over pixels and channels,
/// -1 to 1. Windows of 11 x 11 px weighted by a Gaussian of 1.5 px, K1 = 0.01, K2 = 0.03, peak 1.
double ssim(const Frame& a, const Frame& b);

/// Mean absolute difference of the coverage (alpha), 0 to 1.
double coverageError(const Frame& a, const Frame& b);

/// The pixels within the blur's reach of a depth discontinuity, where depth of field is hard.
///
/// Let d be the vergence 1/U at a pixel of a pinhole frame: 0 where surfaces cover less than half
/// of the pixel, and the median of 3 x 3 pixels, to close gaps between samples. A pixel x along a
/// row or column is a discontinuity if
///   |d(x - s) - 2 d(x) + d(x + s)| > 0.05 max d(x - s, x, x + s).
/// The step s = 3 px straddles an edge that the prefilter has smoothed. On a plane of any slope the
/// left side is exactly 0, because 1/depth is affine on the image. The reach is the largest blur
/// radius of the three pixels, plus s.
/// @param pinhole  a frame without blur, with `depth_m` (asserted), measured along `defocus.along`
/// @return row-major, 1 in the band, else 0
std::vector<std::uint8_t> silhouetteBand(const Frame& pinhole, const Defocus& defocus);

/// `psnr_dB` of the pixels of a band; absent if the band has no pixel.
/// @param band  one entry for each pixel (asserted)
std::optional<double> silhouettePsnr_dB(const Frame& a, const Frame& b,
                                        const std::vector<std::uint8_t>& band);

}  // namespace foci
