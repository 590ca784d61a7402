// How far two frames are apart, in linear light. Both of the same size (asserted), peak 1.
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
/// -1 to 1: windows weighted by a Gaussian of 1.5 px, K1 = 0.01, K2 = 0.03. OpenCV's.
double ssim(const Frame& a, const Frame& b);

/// Mean absolute difference of the coverage (alpha), 0 to 1.
double coverageError(const Frame& a, const Frame& b);

/// Where an image with depth of field is hard: the pixels within the blur's reach of a depth
/// discontinuity.
///   Discontinuity, at a pixel x along a row or a column: with d the vergence 1/U of what a pinhole
///   view shows there (0 where it covers less than half of the pixel; the median of 3 x 3 pixels,
///   against gaps between samples) and s = 3 px, which straddle an edge that the prefilter has
///   smoothed,
///     |d(x - s) - 2 d(x) + d(x + s)| > 0.05 max d(x - s, x, x + s).
///   Exactly 0 on a plane at any slope, whose 1/depth is affine on the image.
///   Reach: the largest circle of confusion of what the three pixels show, and s.
/// @param pinhole  a frame rendered without blur, with `depth_m` (asserted), which is measured
/// along
///                 what `defocus` says
/// @return row-major, 1 in the band, else 0
std::vector<std::uint8_t> silhouetteBand(const Frame& pinhole, const Defocus& defocus);

/// `psnr_dB` of the pixels of a band; nothing where the band has no pixel.
/// @param band  as many as pixels (asserted)
std::optional<double> silhouettePsnr_dB(const Frame& a, const Frame& b,
                                        const std::vector<std::uint8_t>& band);

}  // namespace foci
