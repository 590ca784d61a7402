// The shape of a glTF's meshes at rest: morph targets by their weights, skins by the joints' nodes.
// Private to the readers of meshes.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "render/scene/io/gltf_accessors.h"

namespace foci {

/// Puts meshes in the place of those that have morph targets with weights, or a skin; Assimp would
/// show neither. A vertex v becomes (glTF 2.0, 3.7.2.2 and 3.7.3.3)
///
///   v' = v + sum of w_t d_t over the targets t;   v'' = sum of w_j G_j B_j v' over the joints j,
///
/// with G_j the joint's place in the scene and B_j its inverse bind matrix. Weights of joints are
/// divided by their sum. A mesh with a skin moves to the scene's root, since its node does not
/// place it.
/// @return whether something changed
/// @throws InputError if a skin or a morph target cannot be read, or a vertex names a joint that
/// the skin does not have
bool applyShapes(const std::filesystem::path& path, nlohmann::json& json, GltfAccessors& accessors);

}  // namespace foci
