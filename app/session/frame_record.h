// The record of a frame: eye state, method and cost, without the pixels.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <string>

#include "gaze/follow/gaze_follower.h"
#include "render/methods/method.h"

namespace foci {

/// Points are in px of the session's screen: where the line of sight of the recording, which may
/// have another screen, meets it.
struct FrameRecord {
  double time_s = 0.0;                            ///< on the recording's clock
  glm::dvec3 eye_m{0.0};                          ///< where the eye is: between both eyes
  glm::dquat world_from_eye{1.0, 0.0, 0.0, 0.0};  ///< unit, w >= 0
  EyeNow eye{};
  std::optional<glm::dvec2> gaze_px{};      ///< absent in a blink and during data loss
  std::optional<glm::dvec2> fixation_px{};  ///< stays in saccades, blinks and data loss
  double pupil_mm = 0.0;
  std::string method{};  ///< that rendered the frame
  RenderStats stats{};   ///< of all views together; 0 ms for a reused frame
  bool rendered = true;  ///< false: the previous frame was reused
};

}  // namespace foci
