#pragma once

#include <filesystem>
#include <optional>
#include <utility>
#include <variant>

#include "render/scene/io/open_scene.h"

namespace foci {

/// The Gaussians of a file; nothing for another scene. @throws InputError as `readScene`
inline std::optional<GaussianFile> readGaussians(const std::filesystem::path& path) {
  SceneFile file = readScene(path);
  auto* const gaussians = std::get_if<GaussianFile>(&file.content);
  return gaussians != nullptr ? std::optional(std::move(*gaussians)) : std::nullopt;
}

}  // namespace foci
