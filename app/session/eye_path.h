// Where the eye is over time.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace foci {

/// The pose of the eye at a moment of the recording.
struct EyeKeyframe {
  double time_s = 0.0;  ///< after the recording's first sample
  glm::dvec3 position_m{0.0};
  glm::dvec3 look_at_m{0.0};     ///< what the centre of the screen shows
  std::optional<glm::dvec3> up;  ///< absent: the path's
  bool operator==(const EyeKeyframe&) const = default;
};

/// A rigid pose of the eye, as a head tracker measures it.
struct TrackedPose {
  double time_s = 0.0;  ///< after the recording's first sample
  glm::dvec3 position_m{0.0};
  glm::dquat world_from_eye{1.0, 0.0, 0.0, 0.0};  ///< unit; the eye looks along -z, y is up
  bool operator==(const TrackedPose&) const = default;
};

/// Between keyframes the pose is interpolated linearly. Outside them the eye has the
/// pose of the nearest one. Between the poses of a head tracker the position is interpolated
/// linearly, and the orientation along the shortest arc (slerp, Shoemake 1985).
class EyePath {
 public:
  /// At the origin, looking along -z.
  EyePath();

  /// @param keyframes  at least one, by time
  /// @param source     named in errors
  /// @throws InputError without keyframes
  explicit EyePath(std::vector<EyeKeyframe> keyframes, const glm::dvec3& up = {0.0, 1.0, 0.0},
                   std::string source = "eye path");

  /// @param poses  at least one (asserted), by time
  explicit EyePath(std::vector<TrackedPose> poses);

  /// The next pose of a head that is tracked now. All copies of the path get it.
  void add(const TrackedPose& pose) { poses_->push_back(pose); }

  bool isStill() const { return !poses_ && keyframes_.size() == 1; }

  /// Whether a head tracker moves the eye: what rests in the world then moves in the view.
  bool followsHead() const { return poses_ != nullptr; }

  /// @param time_s  after the recording's first sample
  /// @throws InputError where the line of sight has no length or runs along up, as between two
  ///   keyframes that lead the eye through the point it looks at
  glm::mat4 eyeFromWorldAt(double time_s) const;

  bool operator==(const EyePath& other) const;

 private:
  glm::mat4 headFromWorldAt(double time_s) const;

  std::shared_ptr<std::vector<TrackedPose>> poses_{};  // null: `keyframes_` hold
  std::vector<EyeKeyframe> keyframes_{};
  glm::dvec3 up_{0.0, 1.0, 0.0};
  std::string source_{};
};

}  // namespace foci
