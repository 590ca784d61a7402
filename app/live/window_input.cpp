// The keys and the mouse of `foci live`.
#include <GLFW/glfw3.h>
#include <imgui.h>

#include <algorithm>
#include <array>

#include "app/live/live_window.h"
#include "app/study/study_words.h"

namespace foci {
namespace {

constexpr double kFocusStep_D = 0.25;
constexpr double kClick_px = 4.0;  // a click moves less; chosen by hand

std::string quoted(std::string_view name) { return '"' + std::string(name) + '"'; }

/// The name after `now`; after the last one the first.
template <class Names>
std::string nextOf(const Names& names, std::string_view now) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i] == now) return quoted(names[(i + 1) % names.size()]);
  }
  return quoted(names[0]);
}

bool isOver(const glm::dvec2& point_px, const Screen& screen) {
  return glm::all(glm::greaterThanEqual(point_px, glm::dvec2(0.0))) &&
         glm::all(glm::lessThan(point_px, glm::dvec2(screen.size_px)));
}

/// A key that walks while it is down.
struct WalkKey {
  int key;
  glm::dvec3 direction;  ///< right, up, forwards
  bool plays;            ///< it belongs to the player of a recording instead
};

constexpr std::array kWalkKeys{
    WalkKey{GLFW_KEY_W, {0.0, 0.0, 1.0}, false},
    WalkKey{GLFW_KEY_S, {0.0, 0.0, -1.0}, false},
    WalkKey{GLFW_KEY_A, {-1.0, 0.0, 0.0}, false},
    WalkKey{GLFW_KEY_D, {1.0, 0.0, 0.0}, false},
    WalkKey{GLFW_KEY_E, {0.0, 1.0, 0.0}, false},
    WalkKey{GLFW_KEY_Q, {0.0, -1.0, 0.0}, false},
    WalkKey{GLFW_KEY_UP, {0.0, 0.0, 1.0}, true},
    WalkKey{GLFW_KEY_DOWN, {0.0, 0.0, -1.0}, true},
    WalkKey{GLFW_KEY_LEFT, {-1.0, 0.0, 0.0}, true},
    WalkKey{GLFW_KEY_RIGHT, {1.0, 0.0, 0.0}, true},
    WalkKey{GLFW_KEY_PAGE_UP, {0.0, 1.0, 0.0}, true},
    WalkKey{GLFW_KEY_PAGE_DOWN, {0.0, -1.0, 0.0}, true},
};

}  // namespace

/// A point of the window on the study's screen.
glm::dvec2 LiveWindow::onScreen_px(const glm::dvec2& at_px) const {
  const glm::dvec2 size_px = frame_ ? glm::dvec2(area_.size_px) : window_->size_px();
  return (at_px - glm::dvec2(area_.corner_px)) / size_px * glm::dvec2(screen_.size_px);
}

/// Tells the gaze source where the mouse is, and where it clicks.
void LiveWindow::point() {
  const bool in_scene = !ImGui::GetIO().WantCaptureMouse;
  const glm::dvec2 at_px = window_->cursor_px();
  const glm::dvec2 on_screen_px = onScreen_px(at_px);
  const bool clicks = window_->isButtonDown(GLFW_MOUSE_BUTTON_LEFT) && in_scene;
  if (clicks && !clicked_ && window_->hovered()) pressed_px_ = at_px;
  if ((clicks || clicked_) && glm::distance(at_px, pressed_px_) > kClick_px) orbits_ = true;
  if (!clicks) {
    if (clicked_ && !orbits_ && !outside_ && in_scene && window_->hovered()) {
      const std::string told = feed_->lookedAt(on_screen_px);
      if (!told.empty()) renderer_->tell(told);
    }
    orbits_ = false;
  }
  clicked_ = clicks;
  if (!window_->hovered()) {
    feed_->pointTo(std::nullopt);
  } else if (in_scene && dragNow() == Drag::none && (!outside_ || isOver(on_screen_px, screen_))) {
    feed_->pointTo(on_screen_px);  // over the outside view gaze stays where it is
  }
}

Drag LiveWindow::dragNow() const {
  if (ImGui::GetIO().WantCaptureMouse) return Drag::none;
  if (window_->isButtonDown(GLFW_MOUSE_BUTTON_RIGHT)) return Drag::turn;
  if (window_->isButtonDown(GLFW_MOUSE_BUTTON_MIDDLE)) return Drag::pan;
  return orbits_ ? Drag::orbit : Drag::none;
}

/// Which way the keys that are down, or were since the last look, walk.
glm::dvec3 LiveWindow::walkOf(const std::vector<int>& pressed) const {
  glm::dvec3 walk(0.0);
  const bool commands =
      window_->isDown(GLFW_KEY_LEFT_CONTROL) || window_->isDown(GLFW_KEY_RIGHT_CONTROL);
  if (ImGui::GetIO().WantTextInput || commands) return walk;
  for (const WalkKey& each : kWalkKeys) {
    if (each.plays && feed_->player()) continue;
    if (window_->isDown(each.key) || std::ranges::count(pressed, each.key) > 0) {
      walk += each.direction;
    }
  }
  return glm::clamp(walk, -1.0, 1.0);
}

/// What keys and mouse move: the outside camera, the eye, or nothing.
LiveSteering* LiveWindow::steering() {
  if (outside_) return &outside_->camera();
  return steering_ ? &*steering_ : nullptr;
}

/// Moves the eye, or the outside camera, as keys and mouse say.
void LiveWindow::steer(const std::vector<int>& pressed) {
  constexpr double kFirst_s = 0.01, kMaxPassed_s = 0.05;  // a short press is a step
  const double now_s = clock_.now_s();
  const glm::dvec2 at_px = window_->cursor_px();
  const double wheel = window_->takeWheel();
  const double height_px = frame_ && !outside_ ? area_.size_px.y : window_->size_px().y;
  const Steering input{
      .walk = walkOf(pressed),
      .fast = window_->isDown(GLFW_KEY_LEFT_SHIFT) || window_->isDown(GLFW_KEY_RIGHT_SHIFT),
      .drag = dragNow(),
      .drag_px = at_px - std::exchange(cursor_px_, at_px),
      .tangent_per_px = screen_.size_m.y / screen_.distance_m / height_px,
      .wheel = ImGui::GetIO().WantCaptureMouse ? 0.0 : wheel,
      .passed_s = moves_ ? std::min(now_s - steered_s_, kMaxPassed_s) : kFirst_s};
  steered_s_ = now_s;
  moves_ = input.walk != glm::dvec3(0.0);
  if (LiveSteering* const steering = this->steering()) {
    const bool moved = steering->steer(input, renderer_->state().scene_m, now_s);
    steered_ |= moved && !outside_;
  } else if (moves_ || input.wheel != 0.0) {
    tellWhatMoves();
  }
  sendPose();
}

/// Why keys and mouse do not move the eye.
void LiveWindow::tellWhatMoves() {
  renderer_->tell(renderer_->state().study.eye.path.empty() ? "the recording's head moves the eye"
                                                            : "the study moves the eye (eye.path)");
}

/// Gives the pose to the renderer, once it has the last one.
void LiveWindow::sendPose() {
  if (!steered_ || (sent_.valid() && !isReady(sent_))) return;
  steered_ = false;
  renderer_->change("eye.position_m", tomlPoint(steering_->pose().position_m()));
  sent_ = renderer_->change("eye.look_at_m", tomlPoint(steering_->pose().look_at_m()));
}

/// Back to the first view, or to that before the last change.
void LiveWindow::restoreView(bool first) {
  if (headset_ && first && !outside_) headset_->recentre();
  LiveSteering* const steering = this->steering();
  if (!steering) {
    tellWhatMoves();
  } else if (first) {
    steering->reset(clock_.now_s());
    renderer_->tell("the view is where it began");
    steered_ |= !outside_;
  } else if (steering->undo()) {
    renderer_->tell("the view is as it was before");
    steered_ |= !outside_;
  } else {
    renderer_->tell("no earlier view to go back to");
  }
}

/// @return whether any key was pressed
bool LiveWindow::keys() {
  const std::vector<int> pressed = window_->takeKeys();
  const std::vector<unsigned> typed = window_->takeTyped();
  steer(pressed);
  if (ImGui::GetIO().WantTextInput) return !pressed.empty();
  for (const int each : pressed) {
    if (!keyOfPlayer(each)) key(each);
  }
  for (const unsigned c : typed) {
    if (c == '?' || c == '/') help_ = !help_;
  }
  return !pressed.empty() || !typed.empty();
}

void LiveWindow::play(PlayerStep step) {
  used_s_ = clock_.now_s();
  renderer_->tell(carryOut(step, *feed_->player(), feed_->playback().events));
}

/// @return whether a recording plays, and the key is one of its player's
bool LiveWindow::keyOfPlayer(int key) {
  constexpr std::array<std::pair<int, PlayerStep>, 13> kKeys{
      {{GLFW_KEY_SPACE, PlayerStep::toggle},
       {GLFW_KEY_K, PlayerStep::toggle},
       {GLFW_KEY_LEFT, PlayerStep::back},
       {GLFW_KEY_RIGHT, PlayerStep::forward},
       {GLFW_KEY_COMMA, PlayerStep::frame_back},
       {GLFW_KEY_PERIOD, PlayerStep::frame_forward},
       {GLFW_KEY_J, PlayerStep::fixation_before},
       {GLFW_KEY_L, PlayerStep::fixation_after},
       {GLFW_KEY_HOME, PlayerStep::begin},
       {GLFW_KEY_END, PlayerStep::end},
       {GLFW_KEY_LEFT_BRACKET, PlayerStep::slower},
       {GLFW_KEY_RIGHT_BRACKET, PlayerStep::faster},
       {GLFW_KEY_BACKSLASH, PlayerStep::loop}}};
  const auto found = std::ranges::find(kKeys, key, &std::pair<int, PlayerStep>::first);
  if (!feed_->player() || found == kKeys.end()) return false;
  play(found->second);
  return true;
}

void LiveWindow::changeAndSay(const std::string& name, const std::string& toml) {
  renderer_->tell(changeInWords(name, toml));
  change(name, toml);
}

void LiveWindow::key(int key) {
  const LiveState state = renderer_->state();
  const Study& study = state.study;
  const double focus_D = study.focus.fixed_D.value_or(state.last.eye.focus_D);
  if (key >= GLFW_KEY_1 && key <= GLFW_KEY_8) {
    changeAndSay("observer.pupil_mm", std::to_string(key - GLFW_KEY_0));
    return;
  }
  const auto is = [&](auto... keys) { return ((key == keys) || ...); };
  if (is(GLFW_KEY_ESCAPE)) leaving_ = true;
  if (is(GLFW_KEY_F1)) panel_ = !panel_;
  if (is(GLFW_KEY_F2)) controls_.save_study();
  if (is(GLFW_KEY_F11)) window_->toggleFullScreen();
  if (is(GLFW_KEY_O)) placeObject();
  if (is(GLFW_KEY_F)) {
    changeAndSay("focus.fixed_D", study.focus.fixed_D ? "null" : tomlNumber(focus_D));
  }
  if (is(GLFW_KEY_EQUAL, GLFW_KEY_KP_ADD)) {
    changeAndSay("focus.fixed_D", tomlNumber(std::min(focus_D + kFocusStep_D, 20.0)));
  }
  if (is(GLFW_KEY_MINUS, GLFW_KEY_KP_SUBTRACT)) {
    changeAndSay("focus.fixed_D", tomlNumber(std::max(focus_D - kFocusStep_D, 0.0)));
  }
  if (is(GLFW_KEY_M)) toggle("output.marker", study.output.marker);
  if (is(GLFW_KEY_H)) toggle("output.split", study.output.split);
  if (is(GLFW_KEY_C)) toggle("quality.foveated", study.quality.foveated);
  if (is(GLFW_KEY_V)) {
    changeAndSay("output.view", nextOf(studyWords<StereoView>(), studyWord(study.output.view)));
  }
  if (is(GLFW_KEY_N) && !state.methods.empty()) {
    changeAndSay("render.method", nextOf(state.methods, study.render.method));
  }
  if (is(GLFW_KEY_X)) toggleOutside();
  if (is(GLFW_KEY_R)) toggleRecord();
  if (is(GLFW_KEY_SPACE, GLFW_KEY_T)) renderer_->addMarker(key == GLFW_KEY_T ? "T" : "space");
  if (is(GLFW_KEY_G)) holdGaze();
  if (is(GLFW_KEY_P)) screenshot();
  if (is(GLFW_KEY_HOME, GLFW_KEY_BACKSPACE)) restoreView(true);
  if (is(GLFW_KEY_Z)) restoreView(false);
}

void LiveWindow::toggleOutside() {
  if (!frame_ || outside_scene_.valid()) return;
  if (outside_) {
    outside_.reset();
    in_outside_texture_.reset();
    renderer_->tell("what the eye sees");
  } else {
    outside_scene_ = renderer_->outside();
    renderer_->tell("the scene from outside: drag and keys move its camera");
  }
}

/// Gaze stays where it is, or follows its source again. A record has this as an event marker.
void LiveWindow::holdGaze() {
  const bool held = feed_->holds();
  if (!feed_->hold(!held)) {
    renderer_->tell("no gaze to hold");
    return;
  }
  const std::string told = held ? "gaze is followed again" : "gaze is held";
  if (renderer_->state().record) renderer_->addMarker(told);
  renderer_->tell(told + (held ? "" : "; G follows it again"));
}

/// The panel then shows the object's name and size.
void LiveWindow::placeObject() {
  const glm::dvec2 at_px = onScreen_px(window_->cursor_px());
  if (headset_ || !window_->hovered() || !isOver(at_px, screen_) ||
      ImGui::GetIO().WantCaptureMouse) {
    renderer_->tell(headset_ ? "objects are placed in the window of a screen"
                             : "no surface under the pointer");
    return;
  }
  renderer_->placeObject(at_px);
  panel_ = true;
}

}  // namespace foci
