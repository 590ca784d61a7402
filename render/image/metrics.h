// Differences of two frames in linear light, also as an eye sees them: in just-noticeable
// differences (JND). The frames have the same size (asserted), the peak is 1.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
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

/// Resolution of a 96 dpi screen 0.6 m away, for errors that are measured without a screen.
inline constexpr double kUsualPx_per_deg = 40.0;

/// Standard deviation of the blur of an eye in focus: a grating of 40 cycles a degree keeps a tenth
/// of its contrast.
inline constexpr double kEye_deg = 0.5 / 60.0;

/// A just-noticeable difference of L*a*b* (Mahy, Van Eycken and Oosterlinck 1994).
inline constexpr float kJustNoticeable = 2.3f;

/// Linear RGB with the primaries of sRGB to CIE XYZ, in units of the white D65.
inline const glm::mat3 kXyzOfWhite =
    glm::transpose(glm::mat3(glm::vec3(0.412453f, 0.357580f, 0.180423f) / 0.950456f,
                             glm::vec3(0.212671f, 0.715160f, 0.072169f),
                             glm::vec3(0.019334f, 0.119193f, 0.950227f) / 1.088754f));
/// L*a*b* is this times the curve of XYZ, but for L* = -16 at 0.
inline const glm::mat3 kLabOfCurve(0.0f, 500.0f, 0.0f, 116.0f, -500.0f, 200.0f, 0.0f, 0.0f,
                                   -200.0f);
/// The curve is x^(1/3) from the first on, and below a line of the second as slope.
inline constexpr float kLinearBelow = 0.008856f, kLinearSlope = 7.787f;

/// CIE 1976 L*a*b* difference of each pixel, in JND.
/// Before, both frames are blurred by a Gaussian of `kEye_deg`. White is the display's, and
/// brighter light is clamped to it.
/// @param px_per_deg  resolution at the middle of the display; positive (asserted)
/// @return row-major, one for each pixel. Both frames have the same size (asserted).
std::vector<float> visibleDifference(const Frame& a, const Frame& b, double px_per_deg);

/// CIE 1976 L*a*b* of linear RGB.
glm::vec3 labOf(const glm::vec3& rgb);

/// A frame as this eye sees it, row-major. Use it if many frames are compared with one.
std::vector<glm::vec3> labOf(const Frame& frame, double px_per_deg);

/// The same difference, of a frame from one of the same size as the eye sees it (asserted).
std::vector<float> visibleDifference(const Frame& a, const std::vector<glm::vec3>& lab_b,
                                     double px_per_deg);

/// The Jacobian of L*a*b* at a colour in linear light, in JND for each unit: a small change of
/// light d shows as |J d|. Colours are clamped as above.
glm::mat3 visibleDifferencePerLight(const glm::vec3& rgb);

}  // namespace foci
