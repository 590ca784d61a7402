// A study written as TOML, and the page that lists every key.
#pragma once

#include <filesystem>
#include <string>

#include "app/study/study.h"

namespace foci {

/// The study as TOML that `readStudy` takes in any folder. Files of scene and calibrations have
/// absolute names. The numbers of a monitor replace its file. Files of a recording (gaze.source,
/// record) keep their names.
std::string studyToml(const Study& study);

/// A value of `ResolvedKey::json` as TOML on one line.
std::string tomlOfJson(const std::string& json);

/// The keys that differ from their defaults, and scale and eye, each with its meaning as a comment.
/// Files in `folder` or below it are named relative to it, others absolutely.
/// @param folder   of the file that the text is for
/// @param comment  lines for its head, without "# "
std::string annotatedStudyToml(const Study& study, const std::filesystem::path& folder,
                               const std::string& comment);

/// docs/studies.md: every key with its meaning, its allowed values and its default.
std::string studyKeysMarkdown();

}  // namespace foci
