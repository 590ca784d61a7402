// The finest detail that the observer resolves, as a function of the distance from the gaze.
#pragma once

#include <algorithm>
#include <glm/glm.hpp>

namespace foci {

/// The prefilter that removes detail too fine to see. At r pixels from the gaze it is a Gaussian of
/// standard deviation base_px + per_px r, and at least the one pixel of EWA splatting's prefilter.
struct Acuity {
  glm::vec2 gaze_px{0.0f};  ///< on the image
  float base_px = 1.0f;
  float per_px = 0.0f;
  bool operator==(const Acuity&) const = default;

  /// Standard deviation of the eye's blur `from_gaze_px` from the gaze.
  float eye_px(float from_gaze_px) const { return base_px + per_px * from_gaze_px; }
  /// The same of the prefilter there.
  float finest_px(float from_gaze_px) const { return std::max(eye_px(from_gaze_px), 1.0f); }
};

/// The eye's acuity. At e deg from the gaze its minimum angle of resolution is w = 1/48 + 0.0275 e
/// deg (Guenter et al. 2012; docs/formulas.md, section 8). A Gaussian of w/2 leaves 0.29 of the
/// contrast of the finest grating, of period 2 w.
inline Acuity acuityAround(const glm::vec2& gaze_px, float px_per_deg) {
  return {gaze_px, 0.5f / 48.0f * px_per_deg, 0.5f * 0.0275f};
}

}  // namespace foci
