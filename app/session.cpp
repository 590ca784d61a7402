#include "app/session.h"

#include "gaze/focus/line_of_sight.h"
#include "render/optics/view.h"

namespace foci {

std::optional<glm::dvec2> onOtherScreen_px(const Screen& from, const Screen& to,
                                           const glm::dvec2& point_px) {
  return pointOnScreen_px(to, lineOfSight(from, point_px));
}

Session::Session(const Study& study, const SurfelCloud& cloud, const Screen& screen, double rate_Hz,
                 double start_s)
    : study_(study),
      gaze_screen_(screen),
      screen_(study.screenInForce()),
      start_s_(start_s),
      path_(study),
      query_(cloud),
      method_(makeMethod(study.render.method, cloud)),
      follower_(screen, rate_Hz,
                [this](double time_s, const glm::dvec3& direction_eye, double half_angle_rad) {
                  return surfaceDistance(time_s, direction_eye, half_angle_rad);
                },
                {.events = study.gaze.events,
                 .accommodation = study.focus.accommodation,
                 .cone_half_angle_deg = study.focus.cone_deg,
                 .vergence = study.focus.vergence}),
      pupil_(study) {}

View Session::viewAt(double time_s) const {
  return viewThroughScreen(path_.eyeFromWorldAt(time_s - start_s_), study_.pictureSize_px(),
                           screen_.size_m, screen_.distance_m);
}

std::optional<double> Session::surfaceDistance(double time_s, const glm::dvec3& direction_eye,
                                               double half_angle_rad) const {
  const glm::dmat4 world_from_eye =
      glm::inverse(glm::dmat4(path_.eyeFromWorldAt(time_s - start_s_)));
  return query_.distance(glm::dvec3(world_from_eye[3]),
                         glm::normalize(glm::dmat3(world_from_eye) * direction_eye), half_angle_rad,
                         study_.focus.coverage);
}

FrameRecord Session::render(double time_s, Frame& frame) {
  FrameRecord record{.time_s = time_s,
                     .eye = follower_.at(time_s),
                     .gaze_px = {},
                     .fixation_px = {},
                     .pupil_mm = 0.0,
                     .stats = {}};
  // To the picture an eye that still rings has not landed.
  if (record.eye.state == GazeState::oscillation) record.eye.state = GazeState::saccade;
  const auto on_screen = [&](const std::optional<glm::dvec2>& point_px) {
    return point_px ? onOtherScreen_px(gaze_screen_, screen_, *point_px) : std::nullopt;
  };
  const bool seen = record.eye.state != GazeState::blink && record.eye.state != GazeState::lost;
  if (record.eye.sample && seen) record.gaze_px = on_screen(record.eye.sample->point_px);
  record.fixation_px = on_screen(record.eye.fixation_px);

  last_s_ = time_s;
  if (pupil_.needsPicture()) {
    renderSharp(frame);
    pupil_.show(time_s, frame);
  }
  record.pupil_mm = pupil_.at_mm(time_s);
  const View view = viewAt(time_s);
  const RenderSettings settings{.defocus = defocusOfLens(record.pupil_mm / 1000.0, view.focal_px,
                                                         record.eye.focus_D, DistanceAlong::sight),
                                .background = glm::vec3(study_.scene.background),
                                .shading = static_cast<float>(study_.render.shading)};
  record.stats = method_->render(view, settings, frame);
  pupil_.show(time_s, frame);
  return record;
}

void Session::renderSharp(Frame& frame) {
  RenderSettings settings;
  settings.background = glm::vec3(study_.scene.background);
  settings.shading = static_cast<float>(study_.render.shading);
  method_->render(viewAt(last_s_), settings, frame);
}

glm::dvec2 Session::pictureFromScreen_px(const glm::dvec2& point_px) const {
  return point_px * glm::dvec2(study_.pictureSize_px()) / glm::dvec2(screen_.size_px);
}

}  // namespace foci
