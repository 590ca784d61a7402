// What moves in `foci chart --motion`: the head, the focus, the pupil and the gaze.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include "app/evaluation/scene_in_view.h"
#include "render/optics/view.h"

namespace foci {

/// The eye at a frame.
struct MotionStep {
  std::vector<View> views;  ///< of one eye, or of the left and the right one
  double focus_D = 0.0;
  double rest_D = 0.0;                  ///< where the focus is on its way to
  double pupil_mm = 0.0;                ///< at most `kMaxPupil_mm`
  std::optional<glm::dvec2> gaze_px{};  ///< with foveation
  bool in_saccade = false;
};

/// Through a pupil of this diameter, a scene has the chart's blur.
inline constexpr double kMaxPupil_mm = 6.0;

inline constexpr int kMotionFrames = 48;  ///< of a path, 60 a second

inline constexpr std::array<std::string_view, 7> kMotionPaths{
    "head-1mm", "head-10mm", "stereo", "head-forwards", "focus", "pupil", "saccade"};

/// The steps of a path. A head sways to and fro, so many a frame; equal places have equal views.
/// The focus moves as accommodation does (accommodation.h), to the decile of the vergences in view
/// that lies farther from the scene's focus; the pupil is then so narrow that no blur exceeds the
/// chart's.
std::vector<MotionStep> motionSteps(std::string_view path, const SceneInView& scene);

}  // namespace foci
