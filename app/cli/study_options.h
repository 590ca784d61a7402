// The options that `foci live`, `replay` and `render` share: a study, and what overrides it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/platform/output_guard.h"
#include "app/study/framing.h"
#include "app/study/study.h"
#include "render/scene/io/open_scene.h"

namespace CLI {
class App;
}

namespace foci {

/// Texts as the user typed them; an empty text means that the option was not given.
struct StudyOptions {
  std::string study{}, scene{}, trace{}, screen{}, gaze_map{}, camera{}, size{}, seconds{},
      method{}, device{}, pupil{}, threads{}, view{}, look{}, up{}, write_study{};
  std::vector<std::string> set{};  ///< KEY=VALUE each
  bool json = false, marker = false, split = false, no_cache = false;
};

void addStudyOptions(CLI::App& command, StudyOptions& options);

/// --marker and --split, for commands that follow a gaze.
void addMarkerOptions(CLI::App& command, StudyOptions& options);

/// From where --look looks; from the front if the option was not given. @throws InputError
std::optional<Look> lookOf(const std::string& look);

/// The axis that --up names, if the option was given. @throws InputError
std::optional<UpAxis> upOf(const std::string& up);

struct StudyAsked {
  Study study{};
  std::string framing{};             ///< what was chosen for a scene; empty for a study
  std::optional<SceneFile> scene{};  ///< the file, which the framing has read
};

/// The study with the options applied, checked. A scene instead of a study gets a study with
/// automatic framing, which a line on standard error describes.
/// @throws InputError
StudyAsked studyOf(const StudyOptions& options);

/// Writes the file of --write-study, if the option was given.
void saveStudy(const StudyOptions& options, const StudyAsked& asked, const OutputGuard& guard);

}  // namespace foci
