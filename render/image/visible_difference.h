// The visible difference of two frames, in just-noticeable differences (JND).
#pragma once

#include <glm/glm.hpp>
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

/// A frame as this eye sees it, row-major. Use it if many frames are compared with one.
std::vector<glm::vec3> labOf(const Frame& frame, double px_per_deg);

/// The same difference, of a frame from one of the same size as the eye sees it (asserted).
std::vector<float> visibleDifference(const Frame& a, const std::vector<glm::vec3>& lab_b,
                                     double px_per_deg);

/// The Jacobian of L*a*b* at a colour in linear light, in JND for each unit: a small change of
/// light d shows as |J d|. Colours are clamped as above.
glm::mat3 visibleDifferencePerLight(const glm::vec3& rgb);

}  // namespace foci
