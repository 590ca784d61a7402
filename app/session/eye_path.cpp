#include "app/session/eye_path.h"

#include <algorithm>
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

glm::mat4 EyePath::eyeFromWorldAt(double time_s) const {
  const auto after = std::find_if(keyframes_.begin(), keyframes_.end(),
                                  [&](const EyeKeyframe& frame) { return frame.time_s > time_s; });
  const EyeKeyframe& to = after == keyframes_.end() ? keyframes_.back() : *after;
  const EyeKeyframe& from = after == keyframes_.begin() ? keyframes_.front() : *std::prev(after);
  const double share =
      &from == &to ? 0.0 : std::clamp((time_s - from.time_s) / (to.time_s - from.time_s), 0.0, 1.0);
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
