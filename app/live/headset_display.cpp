#include "app/live/headset_display.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "app/live/pose.h"
#include "app/live/renderer.h"
#include "app/record/gaze_marker.h"
#include "base/input_error.h"
#include "gaze/geometry/line_of_sight.h"
#include "render/scene/surfel_cloud.h"

namespace foci {
namespace {

constexpr double kGaze_Hz = 120.0;  // of the trackers in headsets; runtimes do not state it
constexpr double kBudget = 0.8;     // of a frame's period, for rendering; chosen by hand
constexpr double kLook_s = 1.0;     // between looks at where the displays are
constexpr double kMoved_m = 1e-4;   // of a display, which is taken for a turn of the wheel

glm::dvec4 xyzw(const glm::dquat& q) { return {q.x, q.y, q.z, q.w}; }
glm::dvec4 degreesOf(const EyeField& field) {
  return {field.left_deg, field.right_deg, field.up_deg, field.down_deg};
}

}  // namespace

void HeadInScene::stand(const Study& study) {
  eye_m_ = study.eye.position_m.value_or(glm::dvec3(0.0));
  const glm::dvec3 up = glm::normalize(study.eye.up);
  const glm::dvec3 sight = study.eye.look_at_m.value_or(glm::dvec3(0.0, 0.0, -1.0)) - eye_m_;
  glm::dvec3 back = -(sight - glm::dot(sight, up) * up);
  if (!(glm::length(back) > 1e-6)) back = tangentTo(glm::vec3(up));  // it looks along up
  const glm::dvec3 right = glm::normalize(glm::cross(up, back));
  scene_from_facing_ = glm::quat_cast(glm::dmat3(right, up, glm::cross(right, up)));
}

void HeadInScene::centre(const HeadInWorld& head) {
  const glm::dvec3 sight = head.world_from_head * glm::dvec3(0.0, 0.0, -1.0);
  centre_m_ = head.position_m;
  facing_from_room_ = glm::angleAxis(std::atan2(sight.x, -sight.z), glm::dvec3(0.0, 1.0, 0.0));
}

HeadInWorld HeadInScene::inScene(const HeadInWorld& head) const {
  const glm::dquat turn = scene_from_facing_ * facing_from_room_;
  return {.position_m = eye_m_ + turn * (head.position_m - centre_m_),
          .world_from_head = glm::normalize(turn * head.world_from_head)};
}

/// The headset's gaze, or, if the study says so, the direction of the head.
class HeadsetSource final : public LiveSource {
 public:
  HeadsetSource(HeadsetDisplay& display, const Screen& screen, bool from_head)
      : display_(display), screen_(screen), from_head_(from_head) {}

  void poll(double now_s, std::vector<GazeSample>& samples) override {
    auto gaze = from_head_ ? std::nullopt : display_.gazeInScene();
    if (from_head_ && now_s >= last_s_ + 1.0 / kGaze_Hz) {
      last_s_ = now_s;
      samples.push_back({.time_s = now_s,
                         .point_px = pointOnScreen_px(screen_, glm::dvec3(0.0, 0.0, -1.0)),
                         .head = display_.headNext().in_scene});
    }
    if (!gaze) return;
    const double time_s = std::min(display_.onClock_s(gaze->time_s), now_s);
    // Runtimes answer between samples, too. Where they state no time, an equal answer is the same
    // sample.
    const bool same =
        gaze->own_time && gaze->direction ? time_s <= last_s_ : gaze->direction == last_direction_;
    if (time_s <= last_s_ || (same && time_s < last_s_ + 1.0 / kGaze_Hz)) return;
    last_s_ = time_s;
    last_direction_ = gaze->direction;
    if (gaze->direction) own_time_ = gaze->own_time;
    GazeSample sample{.time_s = time_s,
                      .inferred = gaze->degraded,
                      .queried = !gaze->own_time,
                      .head = gaze->head};
    if (gaze->direction) sample.point_px = pointOnScreen_px(screen_, *gaze->direction);
    samples.push_back(sample);
  }
  double rate_Hz() const override { return kGaze_Hz; }
  std::string status() const override {
    if (from_head_) return "the head's direction";
    const std::string name = "eyes in " + display_.facts().headset;
    if (!own_time_) return name + ", no gaze yet";
    return *own_time_ ? name : name + "; the runtime does not say when it was measured";
  }

 private:
  HeadsetDisplay& display_;
  Screen screen_;
  bool from_head_;
  double last_s_ = -1.0;
  std::optional<glm::dvec3> last_direction_{};
  std::optional<bool> own_time_{};
};

HeadsetDisplay::HeadsetDisplay(const Study& study, std::unique_ptr<GpuContext> context,
                               const LiveClock& clock, std::function<void()> shown,
                               const std::string& loader)
    : clock_(clock), shown_(std::move(shown)), in_scene_(study) {
  if (!context || !context->makeCurrent()) {
    throw InputError("--headset", "no OpenGL 4.5 for a headset: its driver is missing");
  }
  headset_ = std::make_unique<Headset>(std::move(context), loader);
  displays_ = facts().eyes;
  recentre();
  headset_->context().release();
}

HeadsetDisplay::~HeadsetDisplay() {
  stop();
  if (headset_->context().makeCurrent()) headset_.reset();
}

Study HeadsetDisplay::studyHere(Study study) const {
  const auto& [left, right] = facts().eyes;
  Study::Display& display = study.display;
  display.kind = DisplayKind::headset;
  display.field_deg = degreesOf(left.field);
  display.right_field_deg = degreesOf(right.field);
  display.left_eye_m = left.position_m;
  display.right_eye_m = right.position_m;
  display.left_eye_rotation = xyzw(left.head_from_eye);
  display.right_eye_rotation = xyzw(right.head_from_eye);
  study.output.view = StereoView::side_by_side;
  if (!study.output.size_px) study.output.size_px = facts().eye_px * glm::ivec2(2, 1);
  study.screen.gamma.reset();  // runtimes take sRGB
  if (!study.quality.frame_ms) study.quality.frame_ms = 1e3 * kBudget * facts().period_s;
  return study;
}

NamedSource HeadsetDisplay::gaze(const Study& study, const Screen& screen) {
  const bool from_head = study.gaze.columns.space.from_head;
  NamedSource named{.source = std::make_unique<HeadsetSource>(*this, screen, from_head),
                    .screen = screen};
  if (from_head) named.warnings.add("gaze is the direction of the head (gaze.from_head)");
  if (const std::string& problem = facts().no_gaze; !problem.empty() && !from_head) {
    if (!facts().asks_gaze) {
      throw InputError("--headset", problem +
                                        ": expected a headset with an eye tracker, or "
                                        "--set gaze.from_head=true, the head's direction");
    }
    named.warnings.add(problem + "; foci tries to get gaze all the same");
  }
  return named;
}

double HeadsetDisplay::onClock_s(double steady_s) const {
  const auto begin = clock_.at(0.0).time_since_epoch();
  return wholeMicroseconds(steady_s - std::chrono::duration<double>(begin).count());
}

std::optional<HeadsetGaze> HeadsetDisplay::gazeInScene() const {
  auto gaze = headset_->gaze();
  if (!gaze) return std::nullopt;
  const std::lock_guard lock(mutex_);
  gaze->head = in_scene_.inScene(gaze->head);
  return gaze;
}

LiveHead HeadsetDisplay::headNext(const Study* study) {
  const auto now = headset_->headNext();
  const std::lock_guard lock(mutex_);
  if (study) in_scene_.stand(*study);
  if (now || !last_head_) {
    const HeadNow head = now.value_or(HeadNow{});
    last_head_ = {.in_scene = in_scene_.inScene(head.head), .in_room = head.head};
  }
  return *last_head_;
}

void HeadsetDisplay::recentre() {
  if (const auto now = headset_->headNext()) {
    const std::lock_guard lock(mutex_);
    in_scene_.centre(now->head);
  }
}

void HeadsetDisplay::start(LiveRenderer& renderer) {
  renderer_ = &renderer;
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

void HeadsetDisplay::stop() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
}

void HeadsetDisplay::run(const std::stop_token& stop) {
  try {
    if (!headset_->context().makeCurrent()) throw HeadsetLost("the headset's OpenGL is lost");
    while (!stop.stop_requested() && !headset_->ended()) {
      const auto tick = headset_->waitFrame();
      if (!tick) continue;
      // The runtime skips periods if a frame came late: its display repeats the last one.
      const double skipped = std::round((tick->display_s - last_display_s_) / tick->period_s) - 1.0;
      if (last_display_s_ > 0.0 && skipped > 0.0) repeats_ += static_cast<int>(skipped);
      last_display_s_ = tick->display_s;
      followDisplays();
      show(*tick, tick->shows ? renderer_->take(clock_.now_s() + tick->period_s) : nullptr);
    }
    const std::lock_guard lock(mutex_);
    if (headset_->ended()) ended_ = facts().runtime + " has ended the session";
  } catch (...) {
    const std::lock_guard lock(mutex_);
    failure_ = std::current_exception();
  }
  headset_->context().release();
  shown_();
}

/// Shows a frame. Null: the last one stays, at its own pose.
void HeadsetDisplay::show(const HeadsetTick& tick, std::shared_ptr<LiveFrame> frame) {
  if (!frame) {
    headset_->submit(nullptr);
    if (tick.shows) ++repeats_;
    return;
  }
  HeadsetPicture picture{.size_px = {},
                         .markers_px = frame->markers_px,
                         .fixates = isFixating(frame->record),
                         .head = frame->head->in_room,
                         .eyes = frame->head->displays};
  if (frame->texture) {
    picture.texture = frame->texture->beginShow();
    picture.size_px = frame->texture->size_px();
  } else {
    const Image& image = *frame->plain.get();
    picture.rgb = image.rgb.data();
    picture.size_px = image.size_px;
  }
  headset_->submit(&picture);
  if (frame->texture) frame->texture->endShow();
  frame->timing.swap_s = clock_.now_s();
  frame->timing.display_s = onClock_s(tick.display_s);
  frame->timing.repeats = std::exchange(repeats_, 0);
  if (!std::exchange(has_shown_, true)) frame->timing.repeats = 0;  // of no frame
  {
    const std::lock_guard lock(mutex_);
    frames_.push_back(std::move(frame));
  }
  shown_();
}

/// An observer may turn the wheel of the pupil distance.
void HeadsetDisplay::followDisplays() {
  if (clock_.now_s() < looked_s_ + kLook_s) return;
  looked_s_ = clock_.now_s();
  const HeadsetEyes now = headset_->eyesNow();
  constexpr const char* kKeys[] = {"display.left_eye_m", "display.right_eye_m"};
  for (std::size_t side = 0; side < 2; ++side) {
    const glm::dvec3 position_m = now.at(side).position_m;
    if (glm::distance(position_m, displays_.at(side).position_m) < kMoved_m) continue;
    displays_.at(side).position_m = position_m;
    renderer_->change(kKeys[side], tomlPoint(position_m));
  }
}

std::vector<std::shared_ptr<LiveFrame>> HeadsetDisplay::takeShown() {
  const std::lock_guard lock(mutex_);
  return std::exchange(frames_, {});
}

std::string HeadsetDisplay::ended() const {
  const std::lock_guard lock(mutex_);
  if (failure_) std::rethrow_exception(failure_);
  return ended_;
}

}  // namespace foci
