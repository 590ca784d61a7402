// Checks a PLY mesh before Assimp reads it, and gives its properties the names that Assimp knows.
// Private to the readers of meshes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace foci {

/// Refuses a mesh that is cut off, or whose faces name vertices that are not there: Assimp leaves
/// some of these faces out in silence.
/// @return remarks: what foci does not show
/// @throws InputError with the line, or the number of the face
std::vector<std::string> checkPlyFaces(const std::filesystem::path& path);

/// The file with names of properties in lower case, as Assimp knows them. Empty if they are so.
std::string readablePly(const std::filesystem::path& path);

}  // namespace foci
