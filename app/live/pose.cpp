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

std::string tomlNumber(double value) { return decimal(value, 6); }

std::string tomlPoint(const glm::dvec3& point) {
  return "[" + tomlNumber(point.x) + ", " + tomlNumber(point.y) + ", " + tomlNumber(point.z) + "]";
}

}  // namespace foci
