// glTF 2.0 (Khronos), accessors; KHR_mesh_quantization; EXT_mesh_gpu_instancing; EXT_texture_webp.
#include "render/scene/io/gltf_plain.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "base/input_error.h"
#include "base/text.h"
#include "render/scene/io/gaussian_file.h"
#include "render/scene/io/gltf_accessors.h"
#include "render/scene/io/gltf_json.h"
#include "render/scene/io/gltf_shape.h"
#include "render/scene/io/mesh_limits.h"

namespace foci {
namespace {

using JsonValue = nlohmann::json;

class PlainGltf {
 public:
  PlainGltf(const std::filesystem::path& path, JsonValue json)
      : path_(path), json_(std::move(json)), accessors_(path_, json_) {}

  /// @return whether something changed; absent if the file lacks a buffer
  std::optional<bool> rewrite() {
    const bool shaped = applyShapes(path_, json_, accessors_);
    for (const std::size_t accessor : integerAttributes()) {
      const auto values = accessors_.valuesOf(accessor);
      if (!values) return std::nullopt;
      accessors_.replace(accessor, *values);
    }
    const std::optional<bool> instances = addInstances();
    if (!instances) return std::nullopt;
    const bool webp = nameWebp(), floats = accessors_.finish();
    return shaped || floats || *instances || webp;
  }

  std::string text() const { return json_.dump(); }

 private:
  /// Accessors of attributes that have to be floats, and are not.
  std::set<std::size_t> integerAttributes() const {
    std::set<std::size_t> accessors;
    const auto meshes = json_.find("meshes");
    if (meshes == json_.end() || !meshes->is_array()) return accessors;
    for (const JsonValue& mesh : *meshes) {
      if (!mesh.is_object() || !mesh.contains("primitives")) continue;
      for (const JsonValue& primitive : mesh.at("primitives")) {
        if (!primitive.is_object() || !primitive.contains("attributes")) continue;
        for (const auto& [name, number] : primitive.at("attributes").items()) {
          const bool place = name == "POSITION" || name == "NORMAL" || name == "TANGENT" ||
                             name.starts_with("TEXCOORD_");
          if (!place || !number.is_number_unsigned()) continue;
          const auto accessor = number.get<std::size_t>();
          if (accessors_.isInteger(accessor)) accessors.insert(accessor);
        }
      }
    }
    return accessors;
  }

  /// A node below each node that repeats its mesh, for each instance.
  std::optional<bool> addInstances() {
    bool changed = false;
    double instances = 0.0;
    if (!json_.contains("nodes") || !json_["nodes"].is_array()) return false;
    const std::size_t nodes = json_["nodes"].size();
    for (std::size_t n = 0; n < nodes; ++n) {
      const JsonValue::json_pointer attributes("/extensions/EXT_mesh_gpu_instancing/attributes");
      const JsonValue node = json_["nodes"][n];
      if (!node.contains("mesh") || !node.contains(attributes)) continue;
      std::map<std::string, std::vector<float>> values;
      std::size_t count = 0;
      constexpr std::array<std::pair<const char*, std::size_t>, 3> kKeys = {
          {{"translation", 3}, {"rotation", 4}, {"scale", 3}}};
      for (const auto& [key, size] : kKeys) {
        std::string name = key;
        for (char& c : name) c = static_cast<char>(c - 'a' + 'A');
        const std::size_t accessor = numberIn(node.at(attributes), name.c_str(), SIZE_MAX);
        if (accessor == SIZE_MAX) continue;
        auto read = accessors_.valuesOf(accessor);
        if (!read) return std::nullopt;
        count = std::max(count, read->size() / size);
        values[key] = std::move(*read);
      }
      instances += static_cast<double>(count);
      if (instances > kMaxInstances) {
        throw InputError(path_.string(), "has more than " + thousands(kMaxInstances) +
                                             " instances of EXT_mesh_gpu_instancing: expected "
                                             "fewer");
      }
      for (std::size_t i = 0; i < count; ++i) {
        JsonValue instance = {{"mesh", node.at("mesh")}};
        for (const auto& [key, size] : kKeys) {
          const std::vector<float>& all = values[key];
          if (all.size() < (i + 1) * size) continue;
          const auto first = all.begin() + static_cast<std::ptrdiff_t>(i * size);
          instance[key] = std::vector<float>(first, first + static_cast<std::ptrdiff_t>(size));
        }
        if (node.contains("name")) instance["name"] = node.at("name");
        json_["nodes"][n]["children"].push_back(json_["nodes"].size());
        json_["nodes"].push_back(std::move(instance));
      }
      json_["nodes"][n].erase("mesh");
      changed = true;
    }
    return changed;
  }

  bool nameWebp() {
    bool changed = false;
    if (!json_.contains("textures") || !json_["textures"].is_array()) return false;
    const JsonValue::json_pointer source("/extensions/EXT_texture_webp/source");
    for (JsonValue& texture : json_["textures"]) {
      if (!texture.is_object() || texture.contains("source") || !texture.contains(source)) continue;
      texture["source"] = texture.at(source);
      changed = true;
    }
    return changed;
  }

  const std::filesystem::path& path_;
  JsonValue json_;
  GltfAccessors accessors_;
};

void append32(std::string& to, std::size_t value) {
  const auto number = static_cast<std::uint32_t>(value);
  to.append(reinterpret_cast<const char*>(&number),
            sizeof(number));  // little-endian, as the machine
}

/// A binary file with another JSON.
std::string glbWith(const std::filesystem::path& path, std::string json) {
  json.append((4 - json.size() % 4) % 4, ' ');
  const FileBytes file(path);
  const std::uint64_t at =
      kGlbHeader + kChunkHeader + std::uint64_t{u32At(file.part(kGlbHeader, kChunkHeader), 0)};
  const auto rest = file.part(at, file.size() - std::min<std::uint64_t>(at, file.size()));
  std::string glb = "glTF";
  append32(glb, 2);
  append32(glb, kGlbHeader + kChunkHeader + json.size() + rest.size());
  append32(glb, json.size());
  glb += "JSON" + json;
  glb.append(reinterpret_cast<const char*>(rest.data()), rest.size());
  return glb;
}

}  // namespace

std::string plainGltf(GltfDocument gltf) {
  const std::filesystem::path& path = gltf.path;
  if (gltf.altered) {
    if (!gltf.json.contains("skins")) return "";
    throw InputError(path.string(), "has a skin, and is not UTF-8 as glTF has to be: save it so");
  }
  try {
    PlainGltf plain(path, std::move(gltf.json));
    const auto first = firstBytes(path, 4);
    const bool marked = first.size() == 4 && std::memcmp(first.data(), "\xef\xbb\xbf", 3) == 0;
    if (!plain.rewrite().value_or(false) && !marked) return "";
    const bool binary = first.size() == 4 && std::memcmp(first.data(), "glTF", 4) == 0;
    return binary ? glbWith(path, plain.text()) : plain.text();
  } catch (const JsonValue::exception&) {  // parts of another type than glTF states: Assimp says so
    return "";
  }
}

}  // namespace foci
