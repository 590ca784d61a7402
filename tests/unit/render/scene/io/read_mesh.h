// Reads one mesh.
#pragma once

#include <filesystem>
#include <utility>
#include <variant>

#include "base/input_error.h"
#include "render/scene/io/open_scene.h"

namespace foci {

/// @throws InputError also for another scene than a mesh
inline MeshFile readMesh(const std::filesystem::path& path) {
  SceneFile file = readScene(path);
  if (auto* const mesh = std::get_if<MeshFile>(&file.content)) return std::move(*mesh);
  throw InputError(path.string(), "is no mesh");
}

}  // namespace foci
