// Loads what a study names: the scene and the gaze.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "app/platform/warnings.h"
#include "app/study/study.h"
#include "gaze/geometry/gaze_sample.h"
#include "render/scene/builtin/procedural.h"
#include "render/scene/io/open_scene.h"
#include "render/scene/scene.h"

namespace foci {

/// The pose from which a built-in scene is seen if the study names none.
EyePose builtinPose(const Study& study);

/// Warns of what a user should know of the files, and of the place of the eye (view_remarks.h).
/// @param file  the study's scene file, if it has been read
/// @throws InputError
Scene loadScene(const Study& study, Warnings& warnings, std::optional<SceneFile> file = {});

/// The recording that the study names, seen through its calibration. A simulated observer looks at
/// the gallery's points of interest, in other scenes at points spread over the screen, until the
/// end of `output.seconds` or for 20 s.
/// @throws InputError
GazeTrace loadGaze(const Study& study, Warnings& warnings);

/// Prints what was assumed about the recording. Call it once all inputs are read: of bad input only
/// the error is printed.
void sayAssumptions(const Study& study, const GazeTrace& trace);

/// Every file that the result depends on.
std::vector<std::filesystem::path> inputFiles(const Study& study);

}  // namespace foci
