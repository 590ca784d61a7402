// glTF 2.0 (Khronos), skins and morph targets; KHR_texture_basisu.
#include "render/scene/io/gltf_unshown.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace foci {
namespace {

/// Whether an entry of a list of the file has what `holds` asks for.
template <class Holds>
bool anyIn(const nlohmann::json& json, const char* list, const Holds& holds) {
  const auto found = json.find(list);
  return found != json.end() && found->is_array() &&
         std::any_of(found->begin(), found->end(),
                     [&](const auto& entry) { return entry.is_object() && holds(entry); });
}

/// Whether morph targets change the shape.
bool morphs(const nlohmann::json& entry) {
  const auto weights = entry.find("weights");
  return weights != entry.end() && weights->is_array() &&
         std::any_of(weights->begin(), weights->end(),
                     [](const auto& weight) { return weight.is_number() && weight != 0.0; });
}

}  // namespace

std::vector<std::string> gltfUnshown(const GltfDocument& gltf) {
  std::vector<std::string> remarks;
  const nlohmann::json& json = gltf.json;
  if (anyIn(json, "nodes", [](const auto& node) { return node.contains("skin"); })) {
    remarks.emplace_back(
        "meshes with a skeleton are shown as they were modelled, without its pose: apply the pose "
        "in Blender if it matters");
  }
  if (anyIn(json, "meshes", morphs) || anyIn(json, "nodes", morphs)) {
    remarks.emplace_back(
        "morph targets are left out, so meshes have their basic shape: apply them in Blender if "
        "they matter");
  }
  const nlohmann::json::json_pointer basis("/extensions/KHR_texture_basisu");
  if (anyIn(json, "textures", [&](const auto& texture) {
        return !texture.contains("source") && texture.contains(basis);
      })) {
    remarks.emplace_back(
        "textures in KTX2 (KHR_texture_basisu) are left out: make them PNG or JPEG, e.g. with "
        "gltf-transform");
  }
  return remarks;
}

}  // namespace foci
