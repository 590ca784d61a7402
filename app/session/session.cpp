#include "app/session/session.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>
#include <utility>

#include "app/session/observer_eye.h"
#include "base/input_error.h"
#include "gaze/geometry/line_of_sight.h"
#include "render/optics/view.h"

namespace foci {
namespace {

constexpr std::string_view kLiveKeys[] = {
    "eye.position_m",    "eye.look_at_m",      "observer.pupil_mm",  "observer.ipd_mm",
    "focus.fixed_D",     "render.method",      "render.shading",     "scene.background",
    "output.marker",     "output.split",       "output.view",        "quality.tolerance",
    "quality.frame_ms",  "quality.foveated",   "observer.sphere_D",  "observer.cylinder_D",
    "observer.axis_deg", "observer.corrected", "observer.chromatic",
};

/// What `auto` renders holds while it changes by less. Of focus that is what changes radii of blur
/// by so many px for each just noticeable difference of the tolerance, and never more than 1/32 D;
/// of the gaze, a third of a degree.
constexpr double kBlurHold_px = 0.1, kFocusHold_D = 1.0 / 32.0;
constexpr double kPupilHold_mm = 1.0 / 16.0, kGazeHold_px = 12.0;

double held(double value, double before, double most) {
  return std::abs(value - before) <= most ? before : value;
}

}  // namespace

bool holdsTime(const Study& study) {
  return study.render.method == "auto" && study.quality.frame_ms;
}

Quality requestedQuality(const Study& study) {
  Quality quality{.tolerance = static_cast<float>(study.quality.tolerance)};
  if (study.quality.frame_ms) quality.frame_ms = static_cast<float>(*study.quality.frame_ms);
  return quality;
}

bool changesLive(std::string_view key) {
  return std::find(std::begin(kLiveKeys), std::end(kLiveKeys), key) != std::end(kLiveKeys);
}

bool isHeld(const FrameRecord& record) { return !isStable(record.eye.state); }

std::optional<glm::dvec2> onOtherScreen_px(const Screen& from, const Screen& to,
                                           const glm::dvec2& point_px) {
  return pointOnScreen_px(to, lineOfSight(from, point_px));
}

Session::Session(const Study& study, const SurfelCloud& cloud, const Screen& screen, double rate_Hz,
                 double start_s)
    : study_(study),
      gaze_screen_(screen),
      screen_(study.screenInForce()),
      rate_Hz_(rate_Hz),
      start_s_(start_s),
      path_(study),
      query_(cloud),
      renderer_(cloud),
      follower_(newFollower()),
      pupil_(study) {
  renderer_.methodNamed(study.render.method);
}

GazeFollower Session::newFollower() {
  return {gaze_screen_,
          rate_Hz_,
          [this](double time_s, const glm::dvec3& direction_eye, double half_angle_rad) {
            return surfaceDistance(time_s, direction_eye, half_angle_rad);
          },
          {.events = study_.gaze.events,
           .accommodation = accommodationOf(study_),
           .cone_half_angle_deg = study_.focus.cone_deg,
           .vergence = study_.focus.vergence,
           .ipd_m = study_.observer.ipd_mm / 1000.0}};
}

void Session::restart(double start_s) {
  start_s_ = start_s;
  follower_ = newFollower();
  pupil_ = ObserverPupil(study_);
  renderer_ = renderer_.cloneSharingScene();  // methods may remember the frame before
  rendered_.job = {};
  held_.reset();
}

void Session::change(const std::string& key, const std::string& toml) {
  if (!changesLive(key)) {
    throw InputError(key.substr(0, 60), "does not change while foci runs");
  }
  Study changed = study_;
  setKey(changed, key, toml, "change");
  checkStudy(changed);
  path_ = EyePath(changed);
  study_ = std::move(changed);
  pupil_.fix(study_.observer.pupil_mm);
  follower_.setFarPoint(refractionInForce(study_).far_point_D);
  // However small the change, it is to be seen; where the eye stands always is.
  if (!key.starts_with("eye.")) held_.reset();
}

std::vector<EyeView> Session::viewsAt(double time_s) const {
  const View middle = viewThroughScreen(path_.eyeFromWorldAt(time_s - start_s_),
                                        study_.imageSize_px(), screen_.size_m, screen_.distance_m);
  return eyeViews(stereoViewNamed(study_.output.view), middle, study_.observer.ipd_mm / 1000.0,
                  screen_.distance_m);
}

std::optional<double> Session::surfaceDistance(double time_s, const glm::dvec3& direction_eye,
                                               double half_angle_rad) const {
  const glm::dmat4 world_from_eye =
      glm::inverse(glm::dmat4(path_.eyeFromWorldAt(time_s - start_s_)));
  return query_.distance(glm::dvec3(world_from_eye[3]),
                         glm::normalize(glm::dmat3(world_from_eye) * direction_eye), half_angle_rad,
                         study_.focus.coverage);
}

FrameRecord Session::look(double time_s) {
  FrameRecord record{.time_s = time_s,
                     .eye = follower_.at(time_s),
                     .gaze_px = {},
                     .fixation_px = {},
                     .pupil_mm = 0.0,
                     .method = {},
                     .stats = {}};
  // To the image an eye that still rings has not landed.
  if (record.eye.state == GazeState::oscillation) record.eye.state = GazeState::saccade;
  if (study_.focus.fixed_D) {
    record.eye.target_D = study_.focus.fixed_D;
    record.eye.focus_D = reachableFocus_D(accommodationOf(study_), *study_.focus.fixed_D);
  }
  const auto on_screen = [&](const std::optional<glm::dvec2>& point_px) {
    return point_px ? onOtherScreen_px(gaze_screen_, screen_, *point_px) : std::nullopt;
  };
  const bool seen = record.eye.state != GazeState::blink && record.eye.state != GazeState::lost;
  if (record.eye.sample && seen) record.gaze_px = on_screen(record.eye.sample->point_px);
  record.fixation_px = on_screen(record.eye.fixation_px);
  if (pupil_.needsImage()) {
    const View middle =
        viewThroughScreen(path_.eyeFromWorldAt(time_s - start_s_), study_.imageSize_px(),
                          screen_.size_m, screen_.distance_m);
    renderer_.methodNamed(study_.render.method)
        .render(middle,
                {.defocus = {},
                 .background = glm::vec3(study_.scene.background),
                 .shading = static_cast<float>(study_.render.shading)},
                sharp_);
    pupil_.show(time_s, sharp_);
  }
  record.pupil_mm = pupil_.at_mm(time_s);
  if (study_.render.method == "auto") hold(record);
  return record;
}

/// Whether the observer misses what changes now: the eye jumps or is shut. Others who look at the
/// screen do not.
bool Session::isUnseen(const FrameRecord& record) const {
  const GazeState state = record.eye.state;
  return study_.quality.foveated && (state == GazeState::saccade || state == GazeState::blink);
}

double Session::focusHold_D(const FrameRecord& record) const {
  const glm::vec2 focal_px = viewsAt(record.time_s).front().view.focal_px;
  const glm::vec2 px_per_D =
      defocusOfEye(study_, held_->pupil_mm, focal_px, record.eye.focus_D).radius_px_per_D;
  return std::min(kFocusHold_D,
                  kBlurHold_px * study_.quality.tolerance / std::max(px_per_D.x, px_per_D.y));
}

void Session::hold(const FrameRecord& record) {
  if (held_ && isUnseen(record)) return;
  const double focus_D = record.eye.focus_D;
  const double rest_D = record.eye.target_D
                            ? reachableFocus_D(accommodationOf(study_), *record.eye.target_D)
                            : focus_D;
  const bool steady = record.eye.state == GazeState::fixation;
  const auto& gaze_px = record.gaze_px && !steady ? record.gaze_px : record.fixation_px;
  if (!held_) {
    held_ = {.focus_D = focus_D, .rest_D = rest_D, .pupil_mm = record.pupil_mm, .gaze_px = gaze_px};
  }
  held_->pupil_mm = held(record.pupil_mm, held_->pupil_mm, kPupilHold_mm);
  const double most_D = focusHold_D(record);
  held_->rest_D = held(rest_D, held_->rest_D, most_D);
  // Nearly at rest is at rest.
  held_->focus_D = std::abs(focus_D - held_->rest_D) <= most_D
                       ? held_->rest_D
                       : held(focus_D, held_->focus_D, most_D);
  const bool near =
      gaze_px && held_->gaze_px && glm::distance(*gaze_px, *held_->gaze_px) <= kGazeHold_px;
  if (!near) held_->gaze_px = gaze_px;
}

Quality Session::qualityOf(const FrameRecord& record, const EyeView& eye) const {
  Quality quality = requestedQuality(study_);
  if (!study_.quality.foveated) return quality;
  const auto& now_px = record.gaze_px ? record.gaze_px : record.fixation_px;
  if (const auto& point_px = held_ ? held_->gaze_px : now_px) {
    // On the screen, which all views share: where the eye's own view has it.
    const glm::dvec3 sight = lineOfSight(screen_, *point_px);
    const glm::dvec3 p_eye =
        screen_.distance_m / -sight.z * sight - glm::dvec3(eye.offset_m, 0.0, 0.0);
    quality.acuity =
        acuityAround(project(eye.view, glm::vec3(p_eye)),
                     glm::radians(std::sqrt(eye.view.focal_px.x * eye.view.focal_px.y)));
  }
  return quality;
}

RenderRequest Session::jobOf(const std::string& method, const FrameRecord& record) const {
  return held_ ? jobWith(method, record, held_->focus_D, held_->pupil_mm)
               : jobWith(method, record, record.eye.focus_D, record.pupil_mm);
}

RenderRequest Session::jobAtRest(const std::string& method, const FrameRecord& record) const {
  assert(held_);
  return jobWith(method, record, held_->rest_D, held_->pupil_mm);
}

RenderRequest Session::jobWith(const std::string& method, const FrameRecord& record, double focus_D,
                               double pupil_mm) const {
  RenderRequest job{.method = method,
                    .stereo = stereoViewNamed(study_.output.view),
                    .size_px = study_.imageSize_px(),
                    .split = study_.output.split,
                    .eyes = {}};
  for (const EyeView& eye : viewsAt(record.time_s)) {
    RenderSettings settings{.defocus = defocusOfEye(study_, pupil_mm, eye.view.focal_px, focus_D),
                            .background = glm::vec3(study_.scene.background),
                            .shading = static_cast<float>(study_.render.shading)};
    if (method.starts_with("auto")) settings.quality = qualityOf(record, eye);
    if (method == "pinhole") settings.defocus.chromatic_D = glm::vec3(0.0f);  // all alike
    job.eyes.push_back({eye, settings});
  }
  return job;
}

const Frame& Session::render(const std::string& method, FrameRecord& record) {
  const RenderRequest job = jobOf(method, record);
  if (job.holdsTime() && job.sameViews(rendered_.job)) renderer_.prepare(job);
  return render(job, record);
}

const Frame& Session::render(const RenderRequest& job, FrameRecord& record, bool again) {
  const bool done = again || at_leisure_ || isUnseen(record) || !job.holdsTime();
  if (done && rendered_.job == job && !isIncremental(job.method)) {
    rendered_.stats.ms = 0.0;
  } else {
    renderer_.render(job, rendered_);
    at_leisure_ = shown_ = false;
  }
  record.method = rendered_.method;
  record.stats = rendered_.stats;
  record.rendered = !std::exchange(shown_, true);
  pupil_.show(record.time_s, rendered_.frame);
  return rendered_.frame;
}

void Session::adopt(const RenderRequest& job, RenderedFrame&& rendered) {
  rendered_ = std::move(rendered);
  rendered_.job = job;
  at_leisure_ = true;
  shown_ = false;
}

std::vector<glm::dvec2> Session::gazePoints_px(const FrameRecord& record) const {
  const auto& point_px = record.gaze_px ? record.gaze_px : record.fixation_px;
  if (!point_px) return {};
  if (study_.output.view == "mono") {
    return {*point_px * glm::dvec2(study_.imageSize_px()) / glm::dvec2(screen_.size_px)};
  }
  // On the surface that is fixated, so that the two fuse there; else on the screen.
  const glm::dvec3 sight = lineOfSight(screen_, *point_px);
  const double distance_m = record.eye.surface_distance_m.value_or(screen_.distance_m / -sight.z);
  std::vector<glm::dvec2> points_px;
  for (const EyeView& eye : viewsAt(record.time_s)) {
    points_px.push_back(projectForEye(eye, distance_m * sight));
  }
  return points_px;
}

void Session::mark(const FrameRecord& record, Image& image) const {
  if (!study_.output.marker) return;
  for (const glm::dvec2& point_px : gazePoints_px(record)) {
    drawMarker(image, point_px, isHeld(record));
  }
}

}  // namespace foci
