// The report's view of the scene in three dimensions, with plan and side view: WebGL 2 and no
// library, so that the page opens from disk, offline, and stays small.
#pragma once

#include <ostream>

#include "app/replay/scene_view.h"

namespace foci {

extern const char* const kSceneStyle;

/// The section. Its script follows `explorerScript` in the page.
/// @param first_s  time at which the video begins, on the recording's clock
/// @param last_s   and ends
void writeSceneSection(std::ostream& out, const SceneView& view, double first_s, double last_s);

/// The script, with the points and lines: numbers alone.
void writeSceneScript(std::ostream& out, const SceneView& view, double first_s);

}  // namespace foci
