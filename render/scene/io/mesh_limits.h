// What a glTF may ask of Assimp. Assimp follows the nodes of a scene graph without limits, so a
// small file could exhaust the stack, the memory or hours. Private to the readers of meshes.
#pragma once

#include <cstdint>
#include <optional>

#include "render/scene/io/gltf_document.h"

namespace foci {

inline constexpr double kMaxInstances = 1 << 18;  ///< of meshes in a file

struct StatedTriangles {
  std::uint64_t parts = 0, triangles = 0;  ///< of all meshes, whether or not a node shows them
};

/// Refuses a glTF whose nodes nest too deeply, whose node is its own descendant, or whose nodes
/// repeat meshes to too many instances or triangles. Call it before Assimp reads the file.
/// @return the triangles that the file states; absent for points and lines
/// @throws InputError
std::optional<StatedTriangles> refuseHostileGltf(const GltfDocument& gltf);

}  // namespace foci
