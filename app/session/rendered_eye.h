// The eye state that `auto` renders. It follows the observer's eye in steps too small to see, so
// that an eye at rest gives equal requests, and the previous frame is reused.
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "gaze/geometry/gaze_sample.h"

namespace foci {

struct RenderedEye {
  double focus_D = 0.0;
  double rest_D = 0.0;  ///< where focus is on its way to
  double pupil_mm = 0.0;
  std::optional<glm::dvec2> gaze_px;  ///< on the session's screen

  void followPupil(double pupil_mm_now);

  /// Near its rest, focus is taken for at rest.
  /// @param max_change_D  too small to see: `maxUnseenFocusChange_D`
  void followFocus(double focus_D_now, double rest_D_now, double max_change_D);

  void followGaze(const std::optional<glm::dvec2>& gaze_px_now, const Screen& screen);
};

/// How far focus may change before it shows: until blur radii change by a tenth of a pixel for each
/// JND of tolerance, and never more than 1/32 D.
/// @param px_per_D  change of blur radius with focus, along the image's axes
double maxUnseenFocusChange_D(double tolerance, const glm::vec2& px_per_D);

}  // namespace foci
