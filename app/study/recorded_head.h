// A recording with head poses moves the eye of a study.
#pragma once

#include <string>
#include <vector>

#include "app/study/study.h"
#include "gaze/geometry/gaze_sample.h"

namespace foci {

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
