// The options that `foci live`, `replay` and `render` share: a study, and what overrides it.
#pragma once

#include <CLI/CLI.hpp>

#include "app/platform/output_guard.h"
#include "app/study/study_request.h"

namespace foci {

void addStudyOptions(CLI::App& command, StudyRequest& options);

/// --marker and --split, for commands that follow a gaze.
void addMarkerOptions(CLI::App& command, StudyRequest& options);

/// Writes the file of --write-study, if the option was given.
void saveStudy(const StudyRequest& options, const StudyAsked& asked, const OutputGuard& guard);

}  // namespace foci
