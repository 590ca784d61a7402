// Studies as text: one in force as TOML again, and the page that lists every key.
#pragma once

#include <string>

#include "app/study/study.h"

namespace foci {

/// The study in force as TOML, which `readStudy` takes from any folder: the names of the scene's
/// and the calibrations' files are absolute, and a monitor's numbers stand in the place of its
/// file. What belongs to a recording (gaze.source, record) keeps the names that it has.
std::string studyToml(const Study& study);

/// docs/studies.md: every key with its meaning, what it allows and what it is where a study does not
/// name it.
std::string studyKeysMarkdown();

}  // namespace foci
