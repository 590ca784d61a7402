// What a user asks for: a study, or a scene, which gets a study with automatic framing; and what
// overrides its keys.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/study/framing.h"
#include "app/study/study.h"
#include "render/scene/io/open_scene.h"

namespace foci {

/// Texts as the user typed them; an empty text means that the option was not given.
struct StudyRequest {
  std::string study{}, scene{}, trace{}, screen{}, gaze_map{}, camera{}, size{}, seconds{},
      method{}, device{}, pupil{}, threads{}, view{}, look{}, up{}, write_study{};
  std::vector<std::string> set{};  ///< KEY=VALUE each
  bool json = false, marker = false, split = false, no_cache = false;
};

/// Two finite numbers with one character between them: "1280x720", "2:8.5", "960,540".
/// @param option    as the user types it, for the message
/// @param expected  the end of the message
/// @throws InputError
glm::dvec2 pairOf(const std::string& option, const std::string& text, char between,
                  const std::string& expected);

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
StudyAsked studyOf(const StudyRequest& options);

/// A study of the scene with defaults for everything; `frameScene` adds scale and eye. Its messages
/// name the scene.
Study studyOfScene(const std::filesystem::path& scene);

/// Sets scale and eye of a study of a scene file. A scene of one colour is shaded, so that its
/// shape shows.
void frameScene(Study& study, const SceneFacts& facts, const Framing& framing);

/// A study that `readStudy` takes, with comments. Its paths are relative to the folder of `file`.
/// @param about  more lines for its head; may be empty
std::string writtenStudy(const std::filesystem::path& file, const Study& study,
                         const std::string& about);

}  // namespace foci
