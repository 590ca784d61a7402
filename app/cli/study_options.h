// The options that `foci live`, `replay` and `render` share: a study, and what overrides it.
#pragma once

#include "app/platform/output_guard.h"
#include "app/study/study_request.h"

namespace CLI {
class App;
}

namespace foci {

using StudyOptions = StudyRequest;

void addStudyOptions(CLI::App& command, StudyOptions& options);

/// --marker and --split, for commands that follow a gaze.
void addMarkerOptions(CLI::App& command, StudyOptions& options);

/// Writes the file of --write-study, if the option was given.
void saveStudy(const StudyOptions& options, const StudyAsked& asked, const OutputGuard& guard);

}  // namespace foci
