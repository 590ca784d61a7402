// Keys of a study that change while a session runs.
#pragma once

#include <string>

#include "app/session/session.h"
#include "app/study/study.h"

namespace foci {

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
