// What moves in `foci chart --motion`: the head, the focus, the pupil and the gaze.

#include <algorithm>
#include <cstdlib>
#include <glm/gtc/matrix_transform.hpp>

#include "app/evaluation/chart/motion.h"
#include "base/quantile.h"
#include "gaze/focus/accommodation.h"

namespace foci {
namespace {

constexpr double kFrame_s = 1.0 / 60.0;
constexpr float kSlow_m = 0.001f, kFast_m = 0.01f, kForwards_m = 0.005f;  // a frame
constexpr double kPupilStep_mm = 0.1;   // a frame: about the light reflex (Ellis 1981)
constexpr int kSway = 6;                // steps to each side
constexpr int kHalfIpd = 3;             // steps of `kFast_m`: 60 mm from eye to eye
constexpr int kLeaves = 4, kLands = 7;  // frames of a saccade of 50 ms

/// 0, 1, ... `reach`, ... -`reach`, ... 0: a triangle wave of 4 `reach` steps.
int sway(int step, int reach) { return reach - std::abs((step + reach) % (4 * reach) - 2 * reach); }

/// The view of an eye that has moved. @param steps  in the frame of the eye, each of `step_m`
View movedView(View view, const glm::ivec3& steps, float step_m) {
  view.eye_from_world =
      glm::translate(glm::mat4(1.0f), -step_m * glm::vec3(steps)) * view.eye_from_world;
  return view;
}

struct FocusChange {
  double from_D, to_D, pupil_mm;
};

FocusChange focusChangeIn(const SceneInView& scene) {
  std::vector<double> vergences_D;
  for (const float depth_m : scene.depthsInView_m()) vergences_D.push_back(1.0 / depth_m);
  const double low_D = quantile(vergences_D, 0.1), high_D = quantile(vergences_D, 0.9);
  const auto [min_D, max_D] = std::ranges::minmax_element(vergences_D);
  const double from_D{scene.settings.defocus.focus_D};
  const double to_D = from_D - low_D > high_D - from_D ? low_D : high_D;
  const double blur = std::max(*max_D - from_D, from_D - *min_D);
  return {from_D, to_D,
          kMaxPupil_mm * std::min(1.0, blur / std::max(*max_D - to_D, to_D - *min_D))};
}

}  // namespace

std::vector<MotionStep> motionSteps(std::string_view path, const SceneInView& scene) {
  const FocusChange change = focusChangeIn(scene);
  const bool refocuses = path == "focus" || path == "saccade";
  // The focus of path `focus` responds at once, that of path `saccade` after its latency.
  const double begin_s = path == "focus" ? AccommodationSettings{}.latency_s : 0.0;
  Accommodation eye;
  eye.setTarget(0.0, change.from_D);
  if (path == "focus") eye.setTarget(0.0, change.to_D);
  std::vector<MotionStep> steps;
  for (int k = 0; k < kMotionFrames; ++k) {
    if (path == "saccade" && k == kLands) eye.setTarget(kFrame_s * k, change.to_D);
    MotionStep& step = steps.emplace_back();
    step.focus_D = eye.focusAt_D(begin_s + kFrame_s * k);
    step.rest_D = eye.target_D().value();
    step.pupil_mm = refocuses ? change.pupil_mm : kMaxPupil_mm;
    glm::ivec3 moved(0);
    float step_m = kFast_m;
    if (path == "head-1mm") step_m = kSlow_m;
    if (path == "head-1mm" || path == "head-10mm") moved.x = sway(k, kSway);
    if (path == "head-forwards") {
      step_m = kForwards_m;
      moved.z = kSway - sway(k, kSway);
    }
    if (path == "pupil") step.pupil_mm -= kPupilStep_mm * (2 * kSway - sway(k, 2 * kSway));
    if (path == "saccade") {
      step.gaze_px = glm::dvec2(k < kLands ? 0.25 : 0.75, 0.5) * glm::dvec2(scene.view.size_px);
      step.in_saccade = k >= kLeaves && k < kLands;
    }
    if (path == "stereo") {  // each eye at a place of path `head-10mm`
      const int x = sway(k, kSway - kHalfIpd);
      step.views = {movedView(scene.view, {x - kHalfIpd, 0, 0}, step_m),
                    movedView(scene.view, {x + kHalfIpd, 0, 0}, step_m)};
    } else {
      step.views = {movedView(scene.view, moved, step_m)};
    }
  }
  return steps;
}

}  // namespace foci
