#include "app/session/rendered_eye.h"

#include <algorithm>
#include <cmath>

#include "gaze/geometry/line_of_sight.h"

namespace foci {
namespace {

// The steps were chosen by hand. A test bounds their sum: NoOneSeesThatAFrameIsReused, in
// frame_reuse_test.cpp, allows a quarter of the tolerance. The step of gaze is below the size of
// most microsaccades, and changes the finest visible angle (acuity.h) by less than half of its
// value at the gaze: 0.0275 / 3 deg against 1/48 deg.
constexpr double kBlurStep_px = 0.1, kMaxFocusStep_D = 1.0 / 32.0, kPupilStep_mm = 1.0 / 16.0;
constexpr double kGazeStep_deg = 1.0 / 3.0;

double step(double now, double before, double max_change) {
  return std::abs(now - before) <= max_change ? before : now;
}

}  // namespace

void RenderedEye::followPupil(double pupil_mm_now) {
  pupil_mm = step(pupil_mm_now, pupil_mm, kPupilStep_mm);
}

void RenderedEye::followFocus(double focus_D_now, double rest_D_now, double max_change_D) {
  rest_D = step(rest_D_now, rest_D, max_change_D);
  focus_D = std::abs(focus_D_now - rest_D) <= max_change_D
                ? rest_D
                : step(focus_D_now, focus_D, max_change_D);
}

void RenderedEye::followGaze(const std::optional<glm::dvec2>& gaze_px_now, const Screen& screen) {
  const bool near =
      gaze_px_now && gaze_px && angleBetween_deg(screen, *gaze_px_now, *gaze_px) <= kGazeStep_deg;
  if (!near) gaze_px = gaze_px_now;
}

double maxUnseenFocusChange_D(double tolerance, const glm::vec2& px_per_D) {
  return std::min(kMaxFocusStep_D, kBlurStep_px * tolerance / std::max(px_per_D.x, px_per_D.y));
}

}  // namespace foci
