// glTF 2.0 and 1.0 (Khronos).
#include "render/scene/io/gltf_document.h"

#include <algorithm>
#include <utility>

#include "base/input_error.h"
#include "render/scene/io/gltf_json.h"

namespace foci {
namespace {

using Json = nlohmann::json;

constexpr int kMaxJsonDepth = 100;  // chosen by hand: exporters nest about 10 deep

Json parsed(const std::string& text) {
  return Json::parse(text, nullptr, /*allow_exceptions=*/false);
}

}  // namespace

GltfDocument readGltf(const std::filesystem::path& path) {
  std::string text = gltfJson(path);
  if (const int depth = jsonDepth(text); depth > kMaxJsonDepth) {
    throw InputError(path.string(), "its JSON nests " + std::to_string(depth) +
                                        " deep: expected at most " + std::to_string(kMaxJsonDepth));
  }
  GltfDocument gltf{.path = path, .json = parsed(text)};
  if (gltf.json.is_discarded()) {
    std::replace_if(
        text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) >= 0x80; },
        '?');
    gltf.json = parsed(text);
    gltf.altered = true;
  }
  if (!gltf.json.is_object()) {
    throw InputError(path.string(), "is not glTF: expected a JSON object");
  }
  return gltf;
}

std::vector<std::string> requiredExtensions(const GltfDocument& gltf) {
  std::vector<std::string> names;
  const auto found = gltf.json.find("extensionsRequired");
  if (found == gltf.json.end() || !found->is_array()) return names;
  for (const Json& name : *found) {
    if (name.is_string()) names.push_back(name.get<std::string>());
  }
  return names;
}

}  // namespace foci
