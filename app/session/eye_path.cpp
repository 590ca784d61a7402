#include "app/session/eye_path.h"

#include <algorithm>
#include <cassert>
#include <iterator>
#include <utility>

#include "base/input_error.h"
#include "render/optics/view.h"

namespace foci {

EyePath::EyePath() : EyePath({{.look_at_m = {0.0, 0.0, -1.0}, .up = {}}}) {}

EyePath::EyePath(std::vector<EyeKeyframe> keyframes, const glm::dvec3& up, std::string source)
    : keyframes_(std::move(keyframes)), up_(up), source_(std::move(source)) {
  if (keyframes_.empty()) throw InputError(source_, "expected at least one keyframe of the eye");
}

EyePath::EyePath(std::vector<TrackedPose> poses)
    : poses_(std::make_shared<std::vector<TrackedPose>>(std::move(poses))) {
  assert(!poses_->empty());
}

bool EyePath::operator==(const EyePath& other) const {
  const bool same_poses =
      poses_ == other.poses_ || (poses_ && other.poses_ && *poses_ == *other.poses_);
  return same_poses && keyframes_ == other.keyframes_ && up_ == other.up_ &&
         source_ == other.source_;
}

namespace {

/// The neighbours of a time, and the share of the later one.
template <class At>
struct Neighbours {
  const At &from, &to;
  double share;
};

template <class At>
Neighbours<At> neighboursOf(const std::vector<At>& all, double time_s) {
  const auto after = std::ranges::upper_bound(all, time_s, {}, &At::time_s);
  const At& to = after == all.end() ? all.back() : *after;
  const At& from = after == all.begin() ? all.front() : *std::prev(after);
  const double length_s = to.time_s - from.time_s;
  return {from, to, &from == &to ? 0.0 : std::clamp((time_s - from.time_s) / length_s, 0.0, 1.0)};
}

}  // namespace

glm::mat4 EyePath::headFromWorldAt(double time_s) const {
  const auto [from, to, share] = neighboursOf(*poses_, time_s);
  // At a pose itself, the pose: a live run does not know the next one.
  const glm::dquat world_from_eye =
      share == 0.0 ? from.world_from_eye
                   : glm::normalize(glm::slerp(from.world_from_eye, to.world_from_eye, share));
  const glm::dmat3 eye_from_world = glm::mat3_cast(glm::conjugate(world_from_eye));
  glm::dmat4 rigid(eye_from_world);
  rigid[3] = glm::dvec4(-(eye_from_world * glm::mix(from.position_m, to.position_m, share)), 1.0);
  return glm::mat4(rigid);
}

glm::mat4 EyePath::eyeFromWorldAt(double time_s) const {
  if (poses_) return headFromWorldAt(time_s);
  const auto [from, to, share] = neighboursOf(keyframes_, time_s);
  const glm::vec3 position_m(glm::mix(from.position_m, to.position_m, share));
  const glm::vec3 look_at_m(glm::mix(from.look_at_m, to.look_at_m, share));
  const glm::vec3 up(glm::mix(from.up.value_or(up_), to.up.value_or(up_), share));
  const float side = glm::length(glm::cross(look_at_m - position_m, up));
  if (!(side > 0.0f)) {
    throw InputError(source_, "eye.path: at " + std::to_string(time_s) +
                                  " s the line of sight has no length or runs along up");
  }
  return eyeFromWorld(position_m, look_at_m, glm::normalize(up));
}

}  // namespace foci
