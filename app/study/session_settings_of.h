// From a study to the settings of a session.
#pragma once

#include <string>

#include "app/session/session.h"
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

// Keys of a study that change while a session runs.

/// A key that takes another value from a frame on.
struct Change {
  double time_s = 0.0;  ///< of the first frame with the new value
  std::string key;
  std::string toml;  ///< as `setKey` takes it
};

/// The value as remote control may set it. A key that names a file takes those in `remote.folder`
/// alone; the value returned names the file in full.
/// @throws InputError
std::string remoteValue(const Study& study, const std::string& key, const std::string& toml);

/// Sets a key of the study, from the next frame of its session on. Study and session are as they
/// were if this throws.
/// @throws InputError where the key cannot change while a session runs, or not to this value
void changeLive(Study& study, Session& session, const std::string& key, const std::string& toml);

}  // namespace foci
