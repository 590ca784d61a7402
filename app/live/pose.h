// The pose of an eye that mouse and keys move.
#pragma once

#include <glm/glm.hpp>
#include <string>

namespace foci {

/// How far one key moves the eye.
/// @param scene_m  longest side of the scene; 0 if it is not known yet
double liveStep_m(double scene_m);

class LivePose {
 public:
  /// @param up  as the study's
  LivePose(const glm::dvec3& position_m, const glm::dvec3& look_at_m, const glm::dvec3& up);

  /// Moves the eye and the point it looks at.
  /// @param step_m  to the right, up, and forwards on the level
  void move(const glm::dvec3& step_m);

  /// Turns the line of sight. It stops short of straight up or down.
  /// @param angles_rad  to the right, down
  void turn(const glm::dvec2& angles_rad);

  /// Back to the first pose.
  void reset();

  const glm::dvec3& position_m() const { return position_m_; }
  const glm::dvec3& look_at_m() const { return look_at_m_; }

 private:
  glm::dvec3 sight() const { return glm::normalize(look_at_m_ - position_m_); }
  glm::dvec3 rightwards() const { return glm::normalize(glm::cross(sight(), up_)); }

  glm::dvec3 position_m_, look_at_m_, up_;
  glm::dvec3 first_position_m_, first_look_at_m_;
};

/// As `setKey` takes them.
std::string tomlNumber(double value);
std::string tomlPoint(const glm::dvec3& point);

}  // namespace foci
