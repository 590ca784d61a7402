// How fine the observer sees, away from where he looks.
#pragma once

#include <algorithm>
#include <glm/glm.hpp>

namespace foci {

/// Detail is rendered no finer than the observer can see it: at r pixels from the gaze through a
/// Gaussian of base_px + per_px r standard deviation, and never less than the one pixel that every
/// image wants (the prefilter of EWA splatting).
struct Acuity {
  glm::vec2 gaze_px{0.0f};  ///< on the image
  float base_px = 1.0f;
  float per_px = 0.0f;
  bool operator==(const Acuity&) const = default;

  /// Standard deviation of that Gaussian `from_gaze_px` off.
  float finest_px(float from_gaze_px) const {
    return std::max(base_px + per_px * from_gaze_px, 1.0f);
  }
};

/// The eye's: the least angle that it resolves is w = 1/48 + 0.0275 e deg at e deg from the gaze
/// (Guenter et al. 2012). A Gaussian of w/2 leaves 0.29 of the contrast of its finest grating, of
/// period 2 w.
inline Acuity acuityAround(const glm::vec2& gaze_px, float px_per_deg) {
  return {gaze_px, 0.5f / 48.0f * px_per_deg, 0.5f * 0.0275f};
}

}  // namespace foci
