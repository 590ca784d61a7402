// What a glTF states and foci does not show. Private to the readers of meshes.
#pragma once

#include <string>
#include <vector>

#include "render/scene/io/gltf_document.h"

namespace foci {

/// A sentence for each kind: textures in KTX2.
std::vector<std::string> gltfUnshown(const GltfDocument& gltf);

}  // namespace foci
