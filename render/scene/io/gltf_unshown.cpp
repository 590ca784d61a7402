// KHR_texture_basisu.
#include "render/scene/io/gltf_unshown.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace foci {

std::vector<std::string> gltfUnshown(const GltfDocument& gltf) {
  const auto textures = gltf.json.find("textures");
  if (textures == gltf.json.end() || !textures->is_array()) return {};
  const nlohmann::json::json_pointer basis("/extensions/KHR_texture_basisu");
  const bool any = std::any_of(textures->begin(), textures->end(), [&](const auto& texture) {
    return texture.is_object() && !texture.contains("source") && texture.contains(basis);
  });
  if (!any) return {};
  return {
      "textures in KTX2 (KHR_texture_basisu) are left out: make them PNG or JPEG, e.g. with "
      "gltf-transform"};
}

}  // namespace foci
