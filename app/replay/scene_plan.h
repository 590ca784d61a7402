// Plan and side view of a run's scene, for paper.
#pragma once

#include <glm/glm.hpp>
#include <string>

#include "app/replay/scene_view.h"

namespace foci {

enum class SceneSide { above, right };

/// An <svg> element: the scene as an image, without what lies between the viewer and the gaze, and
/// on it the path of the eye, lines of sight, and numbered fixations; the observer looks to the
/// right. Both sides have one scale.
std::string scenePlanSvg(const SceneView& view, SceneSide from);
glm::ivec2 scenePlanSize_px(const SceneView& view, SceneSide from);

}  // namespace foci
