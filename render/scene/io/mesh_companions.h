// The files that a mesh names: materials, textures, buffers.
#pragma once

#include <filesystem>
#include <vector>

namespace foci {

/// The files that a mesh names and that are there, each once: the material files of an OBJ and
/// their textures, the buffers and images of a glTF, the textures of a PLY. Never fails: what
/// cannot be read names none.
std::vector<std::filesystem::path> meshCompanions(const std::filesystem::path& mesh);

}  // namespace foci
