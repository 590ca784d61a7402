// What a glTF states and foci does not show. Private to the readers of meshes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace foci {

/// A sentence for each kind: poses of skeletons, shapes of morph targets, textures in KTX2. None
/// for a file that is no glTF.
std::vector<std::string> gltfUnshown(const std::filesystem::path& path);

}  // namespace foci
