// The options that `foci live`, `replay` and `render` share: a study, and what overrides it.
#pragma once

#include <string>

#include "app/study/study.h"

namespace CLI {
class App;
}

namespace foci {

/// Texts as the user typed them; an empty text means that the option was not given.
struct StudyOptions {
  std::string study{}, scene{}, trace{}, screen{}, gaze_map{}, camera{}, size{}, seconds{},
      method{}, pupil{}, threads{}, view{};
  bool json = false, marker = false, split = false;
};

void addStudyOptions(CLI::App& command, StudyOptions& options);

/// --marker and --split, for commands that follow a gaze.
void addMarkerOptions(CLI::App& command, StudyOptions& options);

/// The study with the options applied, checked. @throws InputError
Study studyOf(const StudyOptions& options);

}  // namespace foci
