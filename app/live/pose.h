// The pose of an eye that mouse and keys move.
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <vector>

namespace foci {

/// How far one step moves the eye.
/// @param scene_m  longest side of the scene; 0 if it is not known yet
double liveStep_m(double scene_m);

class LivePose {
 public:
  /// @param up  as the study's
  LivePose(const glm::dvec3& position_m, const glm::dvec3& look_at_m, const glm::dvec3& up);

  /// Moves the eye and the point it looks at.
  /// @param step_m  to the right, up, and forwards on the level
  void move(const glm::dvec3& step_m);

  /// The same along the view: to the right, up in the image, and along the line of sight.
  void moveInView(const glm::dvec3& step_m);

  /// Turns the line of sight. It stops short of straight up or down.
  /// @param angles_rad  to the right, down
  void turn(const glm::dvec2& angles_rad);

  /// Moves the eye around the point it looks at, as the line of sight turns.
  void orbit(const glm::dvec2& angles_rad);

  /// Back to the first pose.
  void reset();

  const glm::dvec3& position_m() const { return position_m_; }
  const glm::dvec3& look_at_m() const { return look_at_m_; }
  const glm::dvec3& up() const { return up_; }
  double away_m() const { return glm::length(look_at_m_ - position_m_); }

 private:
  glm::dvec3 sight() const { return glm::normalize(look_at_m_ - position_m_); }
  glm::dvec3 rightwards() const { return glm::normalize(glm::cross(sight(), up_)); }

  glm::dvec3 position_m_, look_at_m_, up_;
  glm::dvec3 first_position_m_, first_look_at_m_;
};

enum class Drag { none, turn, orbit, pan };

/// Mouse and keys between two frames.
struct Steering {
  glm::dvec3 walk{0.0};  ///< keys that are down: -1 to 1 to the right, up, forwards
  bool fast = false;
  Drag drag = Drag::none;
  glm::dvec2 drag_px{0.0};       ///< right, down
  double tangent_per_px = 1e-3;  ///< of the view
  double wheel = 0.0;            ///< notches forwards
  double passed_s = 0.0;
};

/// Steers a pose, and undoes it. What follows within half a second is one change.
class LiveSteering {
 public:
  explicit LiveSteering(const LivePose& pose) : pose_(pose) {}

  /// @param scene_m  as of `liveStep_m`
  /// @return whether the pose has changed
  bool steer(const Steering& input, double scene_m, double now_s);
  /// Back to the first pose, which `undo` undoes.
  void reset(double now_s);
  /// Back to before the last change. @return false if there was none
  bool undo();

  const LivePose& pose() const { return pose_; }

 private:
  void remember(double now_s);

  LivePose pose_;
  std::vector<LivePose> before_{};  // each change
  double changed_s_ = -1e9;
};

/// As `setKey` takes them.
std::string tomlNumber(double value);
std::string tomlPoint(const glm::dvec3& point);

}  // namespace foci
