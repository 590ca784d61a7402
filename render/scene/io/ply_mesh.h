// A PLY mesh before Assimp reads it: its faces are checked, and its properties have the names that
// Assimp knows.
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

/// What the vertices have. Assimp makes them black if they have an alpha alone.
struct PlyVertices {
  bool color = true, alpha = false;
};

PlyVertices plyVertices(const std::filesystem::path& path);

/// The file with the names of properties that Assimp knows: in lower case, and alpha for opacity,
/// or for a beside r. Empty if they are so.
std::string readablePly(const std::filesystem::path& path);

}  // namespace foci
