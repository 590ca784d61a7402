// What a study names, loaded: the scene, the gaze, the eye's way through the scene.
#pragma once

#include <filesystem>
#include <vector>

#include "app/study/study.h"
#include "gaze/geometry/gaze_sample.h"
#include "render/scene/builtin/procedural.h"
#include "render/scene/surfel_cloud.h"

namespace foci {

/// The study's eye over time. Between keyframes the pose is interpolated linearly, outside them
/// held.
class EyePath {
 public:
  explicit EyePath(const Study& study);

  /// @param time_s  after the recording's first sample
  /// @throws InputError where two keyframes lead the eye through the point that it looks at
  glm::mat4 eyeFromWorldAt(double time_s) const;

 private:
  std::string file_;
  glm::dvec3 up_;
  std::vector<EyeKeyframe> keyframes_;
};

/// The built-in scene's own pose.
EyePose builtinPose(const Study& study);

/// @throws InputError
SurfelCloud loadScene(const Study& study);

/// The recording that the study names, or one simulated over the scene (the gallery's points of
/// interest, else points spread over the screen) for `output.seconds`, 20 s where absent.
/// @throws InputError
GazeTrace loadGaze(const Study& study);

/// The columns of a recording as the study names them.
TraceColumns columnsOf(const Study& study);

/// Every file that the result depends on.
std::vector<std::filesystem::path> inputFiles(const Study& study);

}  // namespace foci
