// From a study to the settings of a session.
#pragma once

#include <string>

#include "app/session/session_settings.h"
#include "app/study/study.h"
#include "render/scene/builtin/procedural.h"

namespace foci {

/// What the session of a study shows. The study has been checked (`checkStudy`).
SessionSettings sessionSettingsOf(const Study& study);

/// The pose from which a built-in scene is seen if the study names none.
EyePose builtinPose(const Study& study);

/// Where the eye of a study is over time. Its errors name the study's file.
EyePath eyePathOf(const Study& study);

/// Whether the study's method renders the ellipses of an astigmatic eye as circles.
bool ellipsesAsCircles(const Study& study);

/// A sentence for each property of the observer's eyes that the study's method leaves out, or
/// renders in a simpler way; else "".
std::string eyeRemark(const Study& study);

}  // namespace foci
