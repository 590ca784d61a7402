// What an experiment's script may ask of a live run through the socket.
#pragma once

#include <filesystem>
#include <string>

#include "app/live/renderer.h"

namespace foci {

/// Done before the next frame; answered with "ok ..." or "error ...".
///   mark TEXT        "ok TIME": of the mark, on the run's clock, s
///   record [NAME]    a record in a new folder of that name begins
///   stop             it ends
///   set KEY VALUE    a key of the study, as TOML: set observer.pupil_mm 6
///   state            "ok {...}": time, gaze, focus, as JSON
std::string answerTo(const std::string& command, LiveRenderer& renderer, const LiveClock& clock);

/// "foci-20261121-174501" and `extension`, a name that nothing has.
std::filesystem::path unusedName(const std::string& extension);

}  // namespace foci
