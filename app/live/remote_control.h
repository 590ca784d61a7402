// The commands by which the script of an experiment controls a live run.
#pragma once

#include <filesystem>
#include <string>

#include "app/live/renderer.h"

namespace foci {

/// Carries out a command before the next frame.
///
///   mark TEXT        sets an event marker; answers "ok TIME", in seconds on the clock of the run
///   record [NAME]    begins a record in a new folder of that name
///   stop             ends the record
///   set KEY VALUE    sets a key of the study, as TOML: set observer.pupil_mm 6
///   gaze TIME X Y    pushes a sample of the gaze; see `PushedSource::push`
///   state            answers "ok {...}": time, gaze and focus as JSON; where a recording plays
///
/// @return the answer: "ok ..." or "error ..."
std::string answerTo(const std::string& command, LiveRenderer& renderer);

/// A new name from the time of day, e.g. "foci-20261121-174501" and `extension`.
std::filesystem::path unusedName(const std::string& extension);

}  // namespace foci
