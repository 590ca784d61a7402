// Loads the gaze that a study names, and lists the files of a study.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/platform/warnings.h"
#include "app/study/study.h"
#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// The recording that the study names, seen through its calibration. A simulated observer looks at
/// the gallery's points of interest, in other scenes at points spread over the screen, until the
/// end of `output.seconds` or for 20 s.
/// @throws InputError
GazeTrace loadGaze(const Study& study, Warnings& warnings);

/// What looks wrong in the study's screen, where no recording tells (`screenDoubts`).
void addScreenDoubts(const Study& study, Warnings& warnings);

/// Prints what was assumed about the recording. Call it once all inputs are read: of bad input only
/// the error is printed.
void sayAssumptions(const Study& study, const GazeTrace& trace);

/// Every file that the result depends on.
std::vector<std::filesystem::path> inputFiles(const Study& study);

// A recording with head poses moves the eye of a study.

/// Whether the study's recording has head poses, by its first line and the study's columns.
bool recordsHead(const Study& study);

/// R of the alignment, of unit length.
glm::dquat sceneFromRecording(const SceneAlignment& alignment);

/// The study with the eye on the head of the recording: midway between the recorded origins of the
/// eyes, turned as the head is. `gaze.scene_*` aligns the recording's world with the scene. Unless
/// the study has a [screen], the display is the recording's headset. A recording on a screen
/// changes nothing.
Study withRecordedHead(Study study, const GazeTrace& trace);

/// What does not fit between the recording's head and the scene, a sentence each.
std::vector<std::string> headRemarks(const Study& study, const GazeTrace& trace);

}  // namespace foci
