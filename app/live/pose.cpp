#include "app/live/pose.h"

#include <cmath>

#include "base/text.h"

namespace foci {

double liveStep_m(double scene_m) {
  // Chosen by hand: 120 steps cross the scene, 5 cm a step in the built-in gallery.
  constexpr double kSteps = 120.0, kUnknown_m = 0.05;
  return scene_m > 0.0 ? scene_m / kSteps : kUnknown_m;
}

LivePose::LivePose(const glm::dvec3& position_m, const glm::dvec3& look_at_m, const glm::dvec3& up)
    : position_m_(position_m),
      look_at_m_(look_at_m),
      up_(glm::normalize(up)),
      first_position_m_(position_m),
      first_look_at_m_(look_at_m) {}

void LivePose::move(const glm::dvec3& step_m) {
  const glm::dvec3 right = rightwards();
  const glm::dvec3 forwards = glm::cross(up_, right);
  const glm::dvec3 by = step_m.x * right + step_m.y * up_ + step_m.z * forwards;
  position_m_ += by;
  look_at_m_ += by;
}

void LivePose::moveInView(const glm::dvec3& step_m) {
  const glm::dvec3 right = rightwards(), forwards = sight();
  const glm::dvec3 by =
      step_m.x * right + step_m.y * glm::cross(right, forwards) + step_m.z * forwards;
  position_m_ += by;
  look_at_m_ += by;
}

void LivePose::orbit(const glm::dvec2& angles_rad) {
  const glm::dvec3 around_m = look_at_m_;
  turn(angles_rad);
  position_m_ += around_m - look_at_m_;
  look_at_m_ = around_m;
}

void LivePose::turn(const glm::dvec2& angles_rad) {
  constexpr double kMaxCosToUp = 0.98;  // 11 degrees from the vertical: chosen by hand
  const glm::dvec3 forwards = sight(), right = rightwards();
  const glm::dvec3 above = glm::cross(right, forwards);
  const glm::dvec3 turned =
      glm::normalize(forwards + std::tan(angles_rad.x) * right - std::tan(angles_rad.y) * above);
  if (std::abs(glm::dot(turned, up_)) > kMaxCosToUp) return;
  look_at_m_ = position_m_ + glm::length(look_at_m_ - position_m_) * turned;
}

void LivePose::reset() {
  position_m_ = first_position_m_;
  look_at_m_ = first_look_at_m_;
}

namespace {

// Chosen by hand.
constexpr double kSteps_s = 20.0;    // of walking: the scene's longest side in six seconds
constexpr double kNotch = 3.0;       // steps of the wheel
constexpr double kFast = 4.0;        // with shift
constexpr double kDrag_rad = 0.002;  // per pixel
constexpr double kOneChange_s = 0.5;
constexpr std::size_t kMaxUndo = 100;

}  // namespace

void LiveSteering::remember(double now_s) {
  if (now_s - changed_s_ > kOneChange_s) {
    if (before_.size() == kMaxUndo) before_.erase(before_.begin());
    before_.push_back(pose_);
  }
  changed_s_ = now_s;
}

bool LiveSteering::steer(const Steering& input, double scene_m, double now_s) {
  const bool drags = input.drag != Drag::none && input.drag_px != glm::dvec2(0.0);
  if (!drags && input.walk == glm::dvec3(0.0) && input.wheel == 0.0) return false;
  remember(now_s);
  const double step_m = liveStep_m(scene_m) * (input.fast ? kFast : 1.0);
  pose_.move(kSteps_s * input.passed_s * step_m * input.walk);
  pose_.moveInView({0.0, 0.0, kNotch * step_m * input.wheel});
  if (!drags) return true;
  const glm::dvec2 px = input.drag_px;  // the scene follows the mouse
  if (input.drag == Drag::turn) pose_.turn(-kDrag_rad * px);
  if (input.drag == Drag::orbit) pose_.orbit(2.0 * kDrag_rad * px);
  if (input.drag == Drag::pan) {
    const double per_px_m = input.tangent_per_px * pose_.away_m();
    pose_.moveInView({-per_px_m * px.x, per_px_m * px.y, 0.0});
  }
  return true;
}

void LiveSteering::reset(double now_s) {
  changed_s_ = -1e9;
  remember(now_s);
  pose_.reset();
}

bool LiveSteering::undo() {
  if (before_.empty()) return false;
  pose_ = before_.back();
  before_.pop_back();
  changed_s_ = -1e9;
  return true;
}

std::string tomlNumber(double value) { return decimal(value, 6); }

std::string tomlPoint(const glm::dvec3& point) {
  return "[" + tomlNumber(point.x) + ", " + tomlNumber(point.y) + ", " + tomlNumber(point.z) + "]";
}

}  // namespace foci
