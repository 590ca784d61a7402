#include "app/session/session.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "base/input_error.h"
#include "base/transformed.h"
#include "gaze/geometry/line_of_sight.h"
#include "render/methods/quality_level.h"
#include "render/optics/view.h"

namespace foci {
namespace {

/// The GPU that `device` asks for; null: the CPU.
SharedGpu openDevice(RenderDevice device, const SharedGpu& window_gpu) {
  if (device == RenderDevice::cpu) return nullptr;
  if (window_gpu && (device == RenderDevice::gpu || !window_gpu->isSoftware())) return window_gpu;
  try {
    return GpuDevice::open(device == RenderDevice::gpu ? GpuDevice::Kind::any
                                                       : GpuDevice::Kind::hardware);
  } catch (const GpuError& error) {
    if (device == RenderDevice::automatic) return nullptr;
    throw InputError("render.device = \"gpu\"", error.what());
  }
}

std::optional<glm::dvec2> gazeOf(const FrameRecord& record) {
  return record.gaze_px ? record.gaze_px : record.fixation_px;
}

const SessionSettings& checked(const SessionSettings& settings) {
  if (const auto expected = expectedMethod(settings.method)) {
    throw InputError("method " + settings.method, "expected " + *expected);
  }
  const glm::ivec2& size_px = settings.output.size_px;
  if (size_px.x <= 0 || size_px.y <= 0) throw InputError("output size", "expected 1 px or more");
  const StereoView stereo = settings.output.stereo;
  if ((stereo == StereoView::side_by_side && size_px.x % 2 != 0) ||
      (stereo == StereoView::top_bottom && size_px.y % 2 != 0)) {
    throw InputError("output size", "expected an even number of px, to be halved for two eyes");
  }
  return settings;
}

}  // namespace

std::optional<glm::dvec2> onOtherScreen_px(const Screen& from, const Screen& to,
                                           const glm::dvec2& point_px) {
  return pointOnScreen_px(to, lineOfSight(from, point_px));
}

Session::Session(const SessionSettings& settings, const Scene& scene, const Screen& gaze_screen,
                 double rate_Hz, double start_s, const SharedGpu& window_gpu)
    : settings_(checked(settings)),
      gaze_screen_(gaze_screen),
      rate_Hz_(rate_Hz),
      start_s_(start_s),
      query_(scene),
      renderer_(scene, openDevice(settings.device, window_gpu)),
      follower_(newFollower()),
      pupil_(settings) {
  renderer_.methodNamed(settings.method);  // it may take seconds to make, so before the first frame
}

std::string Session::devices() const {
  std::string text;
  for (const std::string& device : devices_) text += device + ", then ";
  const std::string now =
      deviceOf(last_.request.method.empty() ? settings_.method : last_.request.method);
  if (std::ranges::find(devices_, now) == devices_.end()) return text + now;
  return text.substr(0, text.rfind(", then "));
}

/// Notes what rendered `last_`.
void Session::noteDevice() {
  std::string device = deviceOf(last_.request.method);
  if (std::ranges::find(devices_, device) == devices_.end()) devices_.push_back(std::move(device));
}

std::string Session::deviceRemark() const {
  if (!renderer_.gpuFailure().empty()) return renderer_.gpuFailure();
  if (!renderer_.gpu() || renderer_.suitsGpu(settings_.method)) return {};
  return "method " + settings_.method + " has no code for the GPU in this scene; the CPU renders";
}

GazeFollower Session::newFollower() {
  const FocusSettings& focus = settings_.focus;
  return {gaze_screen_,
          rate_Hz_,
          [this](double time_s, const glm::dvec3& direction_eye, double half_angle_rad) {
            return surfaceDistance(time_s, direction_eye, half_angle_rad);
          },
          {.events = settings_.events,
           .accommodation = accommodationOf(settings_),
           .cone_half_angle_deg = focus.cone_deg,
           .vergence = focus.vergence,
           .ipd_m = settings_.observer.ipd_mm / 1000.0}};
}

void Session::restart(double start_s) {
  start_s_ = start_s;
  follower_ = newFollower();
  pupil_ = ObserverPupil(settings_);
  renderer_ = renderer_.cloneSharingScene();  // methods may remember the frame before
  last_.request = {};
  devices_.clear();
  passed_ = false;
  rendered_eye_.reset();
  last_gaze_px_.reset();
}

void Session::changeSettings(const SessionSettings& settings) {
  renderer_.methodNamed(checked(settings).method);  // refuses one that cannot render the scene
  const bool moved = !(settings.path == settings_.path);
  settings_ = settings;
  pupil_.fix(settings_.observer.pupil_mm);
  follower_.setFarPoint(settings_.observer.refraction.far_point_D);
  // The place of the eye is never taken in steps. Any other change, however small, must show.
  if (moved) {
    follower_.noteEyeMoved();
  } else {
    rendered_eye_.reset();
  }
}

View Session::middleViewAt(double time_s) const {
  return viewThroughScreen(settings_.path.eyeFromWorldAt(time_s - start_s_),
                           settings_.output.size_px, settings_.screen.size_m,
                           settings_.screen.distance_m, settings_.screen.faced_m);
}

std::vector<EyeView> Session::viewsAt(double time_s) const {
  const OutputView& output = settings_.output;
  if (settings_.headset && output.stereo != StereoView::mono) {
    return headsetViews(output.stereo, settings_.path.eyeFromWorldAt(time_s - start_s_),
                        *settings_.headset, output.size_px);
  }
  return eyeViews(settings_.output.stereo, middleViewAt(time_s), settings_.observer.ipd_mm / 1000.0,
                  settings_.screen.distance_m);
}

namespace {

/// Where the view shows a point; absent: not in its image.
std::optional<glm::vec2> whereShown_px(const View& view, const glm::vec3& point_m) {
  const glm::vec3 p_eye(view.eye_from_world * glm::vec4(point_m, 1.0f));
  if (-p_eye.z < view.near_m) return std::nullopt;
  const glm::vec2 at_px = project(view, p_eye);
  const bool inside = glm::all(glm::greaterThanEqual(at_px, glm::vec2(0.0f))) &&
                      glm::all(glm::lessThan(at_px, glm::vec2(view.size_px)));
  return inside ? std::optional(at_px) : std::nullopt;
}

}  // namespace

bool Session::isInView(double time_s, std::span<const glm::vec3> points_m) const {
  return std::ranges::any_of(viewsAt(time_s), [&](const EyeView& eye) {
    return std::ranges::any_of(points_m, [&](const glm::vec3& point_m) {
      return whereShown_px(eye.view, point_m).has_value();
    });
  });
}

std::vector<glm::dvec2> Session::linesInImage_px(double time_s,
                                                 std::span<const glm::vec3> ends_m) const {
  std::vector<glm::dvec2> ends_px;
  for (const EyeView& eye : viewsAt(time_s)) {
    for (std::size_t i = 0; i + 1 < ends_m.size(); i += 2) {
      const auto from = whereShown_px(eye.view, ends_m[i]),
                 to = whereShown_px(eye.view, ends_m[i + 1]);
      if (!from || !to) continue;
      for (const auto& end : {*from, *to}) {
        ends_px.push_back(glm::dvec2(eye.corner_px) + glm::dvec2(end));
      }
    }
  }
  return ends_px;
}

std::optional<glm::dvec3> Session::surfaceUnder_m(double time_s, const glm::dvec2& point_px) const {
  const auto distance_m = distanceUnder_m(time_s, point_px);
  if (!distance_m) return std::nullopt;
  const glm::dmat4 eye_from_world(settings_.path.eyeFromWorldAt(time_s - start_s_));
  const glm::dvec3 p_eye = *distance_m * lineOfSight(settings_.screen, point_px);
  return glm::dvec3(glm::inverse(eye_from_world) * glm::dvec4(p_eye, 1.0));
}

std::optional<double> Session::surfaceDistance(double time_s, const glm::dvec3& direction_eye,
                                               double half_angle_rad) const {
  const glm::dmat4 world_from_eye =
      glm::inverse(glm::dmat4(settings_.path.eyeFromWorldAt(time_s - start_s_)));
  return query_.distance(glm::dvec3(world_from_eye[3]),
                         glm::normalize(glm::dmat3(world_from_eye) * direction_eye), half_angle_rad,
                         settings_.focus.coverage);
}

/// To the surface that a point of the screen shows.
std::optional<double> Session::distanceUnder_m(double time_s, const glm::dvec2& point_px) const {
  return surfaceDistance(time_s, lineOfSight(settings_.screen, point_px),
                         glm::radians(settings_.focus.cone_deg));
}

/// Where the session's screen shows at `now_s` what gaze met at `then_s`. A head that turns in
/// between takes the screen with it.
std::optional<glm::dvec2> Session::onScreen_px(const glm::dvec2& point_px, double then_s,
                                               double now_s) const {
  if (!settings_.path.followsHead()) {
    return onOtherScreen_px(gaze_screen_, settings_.screen, point_px);
  }
  const auto turnAt = [&](double time_s) {
    return glm::dmat3(settings_.path.eyeFromWorldAt(time_s - start_s_));
  };
  const glm::dvec3 sight_world =
      glm::transpose(turnAt(then_s)) * lineOfSight(gaze_screen_, point_px);
  return pointOnScreen_px(settings_.screen, turnAt(now_s) * sight_world);
}

FrameRecord Session::look(double time_s) {
  FrameRecord record = recordAt(time_s, AskSurface::always);
  if (choosesQuality(settings_.method)) followEye(record);
  return record;
}

FrameRecord Session::state(double time_s) {
  return recordAt(time_s, settings_.path.isStill() ? AskSurface::whenMoved : AskSurface::always);
}

FrameRecord Session::recordAt(double time_s, AskSurface ask) {
  FrameRecord record{.time_s = time_s, .eye = follower_.at(time_s, ask)};
  // Rendering takes post-saccadic oscillation for a part of the saccade.
  if (record.eye.state == GazeState::oscillation) record.eye.state = GazeState::saccade;
  const auto on_screen = [&](const std::optional<glm::dvec2>& point_px, double at_s) {
    return point_px ? onScreen_px(*point_px, at_s, time_s) : std::nullopt;
  };
  const bool seen = record.eye.state != GazeState::blink && record.eye.state != GazeState::lost;
  if (record.eye.sample && seen) {
    record.gaze_px = on_screen(record.eye.sample->point_px, record.eye.sample->time_s);
  }
  record.fixation_px = on_screen(record.eye.fixation_px, record.eye.fixation_time_s);
  finishLook(record);
  return record;
}

FrameRecord Session::lookSettled(double time_s, const glm::dvec2& point_px) {
  FrameRecord record{.time_s = time_s,
                     .eye = {.time_s = time_s,
                             .state = GazeState::fixation,
                             .state_time_s = time_s,
                             .fixation_px = point_px,
                             .surface_distance_m = distanceUnder_m(time_s, point_px)},
                     .gaze_px = point_px,
                     .fixation_px = point_px};
  EyeNow& eye = record.eye;
  const AccommodationSettings accommodation = accommodationOf(settings_);
  if (eye.surface_distance_m) eye.target_D = 1.0 / *eye.surface_distance_m;
  eye.focus_D =
      eye.target_D ? reachableFocus_D(accommodation, *eye.target_D) : restingFocus_D(accommodation);
  finishLook(record);
  if (choosesQuality(settings_.method)) followEye(record);
  return record;
}

std::optional<glm::dvec2> Session::middleSurface_px(double time_s) const {
  constexpr int kRings = 8, kPoints = 16;
  const glm::dvec2 middle_px = 0.5 * glm::dvec2(settings_.screen.size_px);
  for (int ring = 0; ring <= kRings; ++ring) {
    std::optional<glm::dvec2> nearest_px;
    double nearest_m = std::numeric_limits<double>::infinity();
    for (int i = 0; i < (ring == 0 ? 1 : kPoints); ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kPoints;
      const glm::dvec2 point_px =
          middle_px *
          (1.0 + static_cast<double>(ring) / kRings * glm::dvec2(std::cos(angle), std::sin(angle)));
      const auto distance_m = distanceUnder_m(time_s, point_px);
      if (!distance_m || *distance_m >= nearest_m) continue;
      nearest_m = *distance_m;
      nearest_px = point_px;
    }
    if (nearest_px) return nearest_px;
  }
  return std::nullopt;
}

/// The eye's pose, fixed focus and the pupil.
void Session::finishLook(FrameRecord& record) {
  if (const auto point_px = gazeOf(record)) last_gaze_px_ = point_px;
  const glm::dmat4 world_from_eye =
      glm::inverse(glm::dmat4(settings_.path.eyeFromWorldAt(record.time_s - start_s_)));
  record.eye_m = glm::dvec3(world_from_eye[3]);
  const glm::dquat turn = glm::normalize(glm::quat_cast(glm::dmat3(world_from_eye)));
  record.world_from_eye = turn.w < 0.0 ? -turn : turn;
  if (settings_.focus.fixed_D) {
    record.eye.target_D = settings_.focus.fixed_D;
    record.eye.focus_D = reachableFocus_D(accommodationOf(settings_), *settings_.focus.fixed_D);
  }
  if (pupil_.needsFrame()) showSharpFrame(record.time_s);
  record.pupil_mm = pupil_.at_mm(record.time_s);
}

/// Shows a pupil that follows luminance its first frame. Blur does not change the mean luminance.
void Session::showSharpFrame(double time_s) {
  renderer_.renderView(settings_.method, middleViewAt(time_s),
                       {.defocus = {}, .lighting = settings_.lighting}, sharp_);
  pupil_.show(time_s, sharp_);
}

/// Whether the observer cannot see a change now: the eye jumps or is shut. Other viewers of the
/// screen can.
bool Session::isUnseen(const FrameRecord& record) const {
  const GazeState state = record.eye.state;
  return settings_.quality.foveated && (state == GazeState::saccade || state == GazeState::blink);
}

void Session::followEye(const FrameRecord& record) {
  if (rendered_eye_ && isUnseen(record)) return;
  const double focus_D = record.eye.focus_D;
  const double rest_D = record.eye.target_D
                            ? reachableFocus_D(accommodationOf(settings_), *record.eye.target_D)
                            : focus_D;
  const bool steady = record.eye.state == GazeState::fixation;
  const auto& gaze_px = record.gaze_px && !steady ? record.gaze_px : record.fixation_px;
  if (!rendered_eye_) {
    rendered_eye_ = {
        .focus_D = focus_D, .rest_D = rest_D, .pupil_mm = record.pupil_mm, .gaze_px = gaze_px};
  }
  rendered_eye_->followPupil(record.pupil_mm);
  const glm::vec2 focal_px = viewsAt(record.time_s).front().view.focal_px;
  const Defocus defocus =
      defocusOfEye(settings_.observer, rendered_eye_->pupil_mm, focal_px, focus_D);
  rendered_eye_->followFocus(
      focus_D, rest_D,
      maxUnseenFocusChange_D(settings_.quality.tolerance, defocus.radius_px_per_D));
  rendered_eye_->followGaze(gaze_px, settings_.screen);
}

Quality Session::qualityOf(const FrameRecord& record, const EyeView& eye) const {
  Quality quality{.tolerance = static_cast<float>(settings_.quality.tolerance)};
  if (settings_.quality.frame_ms)
    quality.frame_ms = static_cast<float>(*settings_.quality.frame_ms);
  if (!settings_.quality.foveated) return quality;
  if (const auto& point_px = rendered_eye_ ? rendered_eye_->gaze_px : gazeOf(record)) {
    quality.acuity =
        acuityAround(inView_px(*point_px, eye),
                     glm::radians(std::sqrt(eye.view.focal_px.x * eye.view.focal_px.y)));
  }
  return quality;
}

/// A point of the screen, which all views share, where the eye's own view shows it.
glm::vec2 Session::inView_px(const glm::dvec2& point_px, const EyeView& eye) const {
  const Screen& screen = settings_.screen;
  const glm::dvec3 sight = lineOfSight(screen, point_px);
  return project(eye.view, glm::vec3(eye.inEye(screen.distance_m / -sight.z * sight)));
}

/// The eye's lens over its view. Gaze that is lost stays; before the first, it is straight ahead.
void Session::addField(const FrameRecord& record, const EyeView& eye, Defocus& defocus) const {
  if (!settings_.observer.field || defocus.radius_px_per_D == glm::vec2(0.0f)) return;
  std::optional<glm::dvec2> point_px = rendered_eye_ ? rendered_eye_->gaze_px : gazeOf(record);
  if (!point_px) point_px = last_gaze_px_;
  field_.set(*settings_.observer.field, eye.isLeft(), eye.view,
             point_px ? inView_px(*point_px, eye) : eye.view.principal_px, defocus);
}

RenderRequest Session::requestOf(const std::string& method, const FrameRecord& record) const {
  return rendered_eye_
             ? requestWith(method, record, rendered_eye_->focus_D, rendered_eye_->pupil_mm)
             : requestWith(method, record, record.eye.focus_D, record.pupil_mm);
}

RenderRequest Session::requestAtRest(const std::string& method, const FrameRecord& record) const {
  assert(rendered_eye_);
  return requestWith(method, record, rendered_eye_->rest_D, rendered_eye_->pupil_mm);
}

RenderRequest Session::requestWith(const std::string& method, const FrameRecord& record,
                                   double focus_D, double pupil_mm) const {
  RenderRequest request{.method = method,
                        .stereo = settings_.output.stereo,
                        .size_px = settings_.output.size_px,
                        .split = settings_.output.split};
  for (const EyeView& eye : viewsAt(record.time_s)) {
    RenderSettings settings{
        .defocus = defocusOfEye(settings_.observer, pupil_mm, eye.view.focal_px, focus_D),
        .pupil = pupilOfEye(settings_.observer, eye.isLeft(), pupil_mm, eye.view.focal_px, focus_D),
        .lighting = settings_.lighting,
        .depth = settings_.output.depth};
    addField(record, eye, settings.defocus);
    if (usesQuality(method)) settings.quality = qualityOf(record, eye);
    // Without blur all colours are equally sharp.
    if (settings_.observer.chromatic && method != "pinhole") {
      settings.colours = settings_.colours.empty() ? coloursOfPrimaries() : settings_.colours;
    }
    request.eyes.push_back({eye, settings});
  }
  return request;
}

const Frame& Session::render(const std::string& method, FrameRecord& record) {
  renderer_.read(renderKept(method, record));
  return last_.frame;
}

RenderedFrame& Session::renderKept(const std::string& method, FrameRecord& record) {
  const RenderRequest request = requestOf(method, record);
  if (request.hasTimeBudget() && request.sameViews(last_.request)) renderer_.prepare(request);
  return renderKept(request, record);
}

void Session::pass(const std::string& method, FrameRecord& record) {
  if (settings_.observer.pupil == PupilModel::luminance) {
    render(method, record);
    return;
  }
  const RenderRequest request = requestOf(method, record);
  if (last_.request == request) return;
  renderer_.pass(request);
  last_.request = request;
  full_quality_ = false;
  passed_ = returned_ = true;
}

const Frame& Session::render(const RenderRequest& request, FrameRecord& record,
                             bool again_is_useless) {
  renderer_.read(renderKept(request, record, again_is_useless));
  return last_.frame;
}

RenderedFrame& Session::renderKept(const RenderRequest& request, FrameRecord& record,
                                   bool again_is_useless) {
  if (std::exchange(passed_, false) && last_.request == request) {
    renderer_.renderPassed(request, last_);
  }
  const bool done =
      again_is_useless || full_quality_ || isUnseen(record) || !request.hasTimeBudget();
  const bool lost = last_.on_gpu && !renderer_.gpu();  // the GPU has failed since then
  if (done && !lost && last_.request == request && !methodInfo(request.method).incremental) {
    last_.stats.ms = 0.0;
    last_.stats.gpu.reset();
  } else {
    renderer_.renderKept(request, last_);
    noteDevice();
    full_quality_ = returned_ = false;
  }
  record.method = last_.method;
  record.stats = last_.stats;
  record.rendered = !std::exchange(returned_, true);
  if (pupil_.followsFrames()) {
    renderer_.read(last_);
    pupil_.show(record.time_s, last_.frame);
  }
  return last_;
}

void Session::adopt(const RenderRequest& request, RenderedFrame& rendered) {
  std::swap(last_, rendered);
  last_.request = request;
  full_quality_ = true;
  returned_ = passed_ = false;
}

std::vector<glm::dvec2> Session::gazePoints_px(const FrameRecord& record) const {
  const auto& point_px = record.gaze_px ? record.gaze_px : record.fixation_px;
  if (!point_px) return {};
  const Screen& screen = settings_.screen;
  if (settings_.output.stereo == StereoView::mono) {
    return {*point_px * glm::dvec2(settings_.output.size_px) / glm::dvec2(screen.size_px)};
  }
  // On the surface that is fixated, so that both points fuse there; else on the screen.
  const glm::dvec3 sight = lineOfSight(screen, *point_px);
  const double distance_m = record.eye.surface_distance_m.value_or(screen.distance_m / -sight.z);
  return transformed(viewsAt(record.time_s),
                     [&](const EyeView& eye) { return projectForEye(eye, distance_m * sight); });
}

}  // namespace foci
