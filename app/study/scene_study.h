// A study made from a scene alone, with automatic framing.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "app/study/framing.h"
#include "app/study/study.h"

namespace foci {

/// A study of the scene with defaults for everything; `frameScene` adds scale and eye. Its messages
/// name the scene.
Study studyOfScene(const std::filesystem::path& scene);

/// Sets scale and eye of a study of a scene file, for the study's screen.
/// @return what was chosen, see `framingText`
std::string frameScene(Study& study, const SceneFacts& facts, const std::optional<Look>& look,
                       const std::optional<UpAxis>& up);

/// The same with a framing at hand. A scene of one colour is shaded, so that its shape
/// shows.
void frameScene(Study& study, const SceneFacts& facts, const Framing& framing);

/// Shades a scene of one colour, as `frameScene` does.
void shadePlainScene(Study& study, const SceneFacts& facts);

/// A study that `readStudy` takes, with comments. Its paths are relative to the folder of `file`.
/// @param about  more lines for its head; may be empty
std::string writtenStudy(const std::filesystem::path& file, const Study& study,
                         const std::string& about);

}  // namespace foci
