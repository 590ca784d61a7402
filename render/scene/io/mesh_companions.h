// The files that a mesh names: materials, textures, buffers.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace foci {

/// The files that a mesh names and that are there, each once: the material files of an OBJ and
/// their textures, the buffers and images of a glTF. Never fails: what cannot be read names none.
std::vector<std::filesystem::path> meshCompanions(const std::filesystem::path& mesh);

/// The names of the materials that the MTL files of an OBJ define. Empty if no file is there.
std::vector<std::string> definedMaterials(const std::filesystem::path& obj);

}  // namespace foci
