// What a mesh file may ask of Assimp. Assimp follows nested JSON and the nodes of a scene graph
// without limits, so a small file could exhaust the stack, the memory or hours.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace foci {

inline constexpr double kMaxInstances = 1 << 18;  ///< of meshes in a file

struct StatedTriangles {
  std::uint64_t parts = 0, triangles = 0;  ///< of all meshes, whether or not a node shows them
};

/// Refuses what is not a file, and a glTF file whose JSON or whose nodes nest too deeply, whose
/// node is its own descendant, or whose nodes repeat meshes to too many instances or triangles.
/// Other formats pass: they have neither JSON nor instances. Call it before Assimp reads the file.
/// @return the triangles that a glTF states; absent for other files, and for points and lines
/// @throws InputError
std::optional<StatedTriangles> refuseHostileMesh(const std::filesystem::path& path);

}  // namespace foci
