// From a study to the settings of a session.
#pragma once

#include <string>

#include "app/session/session_settings.h"
#include "app/study/study.h"

namespace foci {

/// What the session of a study shows. The study has been checked (`checkStudy`).
SessionSettings sessionSettingsOf(const Study& study);

/// Where the eye of a study is over time. Its errors name the study's file.
EyePath eyePathOf(const Study& study);

/// If the study's method renders the ellipses of an astigmatic eye as circles, a sentence that says
/// so; else "".
std::string ellipseRemark(const Study& study);

}  // namespace foci
