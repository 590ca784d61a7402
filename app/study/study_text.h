// A study written as TOML, and the page that lists every key.
#pragma once

#include <string>

#include "app/study/study.h"

namespace foci {

/// The study as TOML that `readStudy` takes in any folder. Files of scene and calibrations have
/// absolute names. The numbers of a monitor replace its file. Files of a recording (gaze.source,
/// record) keep their names.
std::string studyToml(const Study& study);

/// docs/studies.md: every key with its meaning, its allowed values and its default.
std::string studyKeysMarkdown();

}  // namespace foci
