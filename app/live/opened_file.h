// A file that is dropped on the window of `foci live`.
#pragma once

#include <filesystem>
#include <string>

#include "app/live/options.h"
#include "app/study/study_request.h"

namespace foci {

/// What the window shows then: a scene or a study, or else a recording, which plays in the study
/// that is shown.
/// @param options  of the command, for a scene or a study: --size, --device and --no-cache
/// @param source   of the gaze so far
/// @throws InputError
LiveNext openedFile(const std::filesystem::path& file, const StudyRequest& options,
                    const std::string& source, const Study& now);

}  // namespace foci
