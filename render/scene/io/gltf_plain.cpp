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
#include <span>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include "base/base64.h"
#include "base/input_error.h"
#include "base/text.h"
#include "render/scene/io/gaussian_file.h"
#include "render/scene/io/gltf_json.h"
#include "render/scene/io/mesh_limits.h"

namespace foci {
namespace {

using JsonValue = nlohmann::json;

constexpr int kFloat = 5126;
constexpr std::size_t kGlbHeader = 12, kChunkHeader = 8;

/// A whole number of a JSON object; `otherwise` if it has none.
std::size_t numberIn(const JsonValue& object, const char* key, std::size_t otherwise) {
  const auto found = object.is_object() ? object.find(key) : object.end();
  const bool is = object.is_object() && found != object.end() && found->is_number_unsigned();
  return is ? found->get<std::size_t>() : otherwise;
}

const JsonValue* listEntry(const JsonValue& json, const char* list, std::size_t number) {
  const auto found = json.find(list);
  if (found == json.end() || !found->is_array() || number >= found->size()) return nullptr;
  return &found->at(number);
}

/// How a component is stored.
struct Component {
  std::size_t bytes;
  float most;  ///< of a normalised integer
  float (*read)(const unsigned char*);
};

template <class T>
float valueAt(const unsigned char* from) {
  T value;
  std::memcpy(&value, from, sizeof(T));
  return static_cast<float>(value);
}

std::optional<Component> componentOf(std::size_t type) {
  switch (type) {
    case 5120:
      return Component{1, 127.0f, valueAt<std::int8_t>};
    case 5121:
      return Component{1, 255.0f, valueAt<std::uint8_t>};
    case 5122:
      return Component{2, 32767.0f, valueAt<std::int16_t>};
    case 5123:
      return Component{2, 65535.0f, valueAt<std::uint16_t>};
    case kFloat:
      return Component{4, 1.0f, valueAt<float>};
    default:
      return std::nullopt;
  }
}

class PlainGltf {
 public:
  PlainGltf(const std::filesystem::path& path, JsonValue json)
      : path_(path), json_(std::move(json)) {}

  /// @return whether something changed; absent if the file lacks a buffer
  std::optional<bool> rewrite() {
    for (const std::size_t accessor : integerAttributes()) {
      const auto values = valuesOf(accessor);
      if (!values) return std::nullopt;
      JsonValue& rewritten = json_["accessors"][accessor];
      rewritten["bufferView"] = json_["bufferViews"].size();
      rewritten["componentType"] = kFloat;
      for (const char* key : {"byteOffset", "normalized", "min", "max"}) rewritten.erase(key);
      const std::size_t bytes = values->size() * sizeof(float);
      json_["bufferViews"].push_back({{"buffer", json_["buffers"].size()},
                                      {"byteOffset", floats_.size() * sizeof(float)},
                                      {"byteLength", bytes}});
      floats_.insert(floats_.end(), values->begin(), values->end());
    }
    if (!floats_.empty()) {
      const std::size_t bytes = floats_.size() * sizeof(float);
      std::ostringstream uri;
      uri << "data:application/octet-stream;base64,";
      Base64 base64(uri);
      base64.add(reinterpret_cast<const std::uint8_t*>(floats_.data()), bytes);
      base64.finish();
      json_["buffers"].push_back({{"byteLength", bytes}, {"uri", uri.str()}});
    }
    const std::optional<bool> instances = addInstances();
    if (!instances) return std::nullopt;
    const bool webp = nameWebp(), skins = dropSkins();
    return !floats_.empty() || *instances || webp || skins;
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
          const JsonValue* accessor = listEntry(json_, "accessors", number.get<std::size_t>());
          if (accessor == nullptr) continue;
          const std::size_t type = numberIn(*accessor, "componentType", kFloat);
          if (type != kFloat && componentOf(type)) accessors.insert(number.get<std::size_t>());
        }
      }
    }
    return accessors;
  }

  /// The numbers of an accessor. Absent if its buffer is not there.
  std::optional<std::vector<float>> valuesOf(std::size_t number) {
    const JsonValue* const accessor = listEntry(json_, "accessors", number);
    const JsonValue* const view =
        accessor ? listEntry(json_, "bufferViews", numberIn(*accessor, "bufferView", SIZE_MAX))
                 : nullptr;
    const auto component = accessor ? componentOf(numberIn(*accessor, "componentType", 0))
                                    : std::optional<Component>();
    if (view == nullptr || !component || accessor->contains("sparse")) return std::nullopt;
    const auto bytes = bufferOf(numberIn(*view, "buffer", SIZE_MAX));
    if (!bytes) return std::nullopt;
    const std::string type = accessor->value("type", "");
    const std::size_t components = type == "VEC2" ? 2 : type == "VEC3" ? 3 : type == "VEC4" ? 4 : 1;
    const std::size_t record = components * component->bytes;
    const std::size_t stride = std::max(numberIn(*view, "byteStride", record), record);
    const std::size_t count = numberIn(*accessor, "count", 0);
    const std::size_t start =
        numberIn(*view, "byteOffset", 0) + numberIn(*accessor, "byteOffset", 0);
    const bool inside = start <= bytes->size() && bytes->size() - start >= record &&
                        (bytes->size() - start - record) / stride + 1 >= count;
    if (count > 0 && !inside) {
      throw InputError(path_.string(), "accessor " + std::to_string(number) +
                                           " reaches beyond its buffer of " +
                                           thousands(static_cast<double>(bytes->size())) +
                                           " bytes: is the file cut off?");
    }
    const bool normalized = accessor->value("normalized", false);
    std::vector<float> values(count * components);
    for (std::size_t i = 0; i < values.size(); ++i) {
      const std::size_t at = start + i / components * stride + i % components * component->bytes;
      const float raw = component->read(bytes->data() + at);
      values[i] = normalized ? std::max(raw / component->most, -1.0f) : raw;
    }
    return values;
  }

  std::optional<std::span<const unsigned char>> bufferOf(std::size_t number) {
    const JsonValue* const buffer = listEntry(json_, "buffers", number);
    if (buffer == nullptr) return std::nullopt;
    auto found = buffers_.find(number);
    if (found == buffers_.end()) {
      const std::string uri = buffer->value("uri", "");
      std::vector<unsigned char> bytes;
      if (uri.empty()) {
        bytes = binaryChunk();
      } else if (uri.starts_with("data:")) {
        bytes =
            bytesOfBase64(std::string_view(uri).substr(std::min(uri.find(',') + 1, uri.size())));
      } else {
        const std::filesystem::path file = path_.parent_path() / percentDecoded(uri);
        std::error_code ignored;
        if (!std::filesystem::is_regular_file(file, ignored)) return std::nullopt;
        const FileBytes read(file);
        bytes.assign(read.all().begin(), read.all().end());
      }
      found = buffers_.emplace(number, std::move(bytes)).first;
    }
    return found->second;
  }

  /// Of a binary file, after the chunk of the JSON; the JSON before it is padded.
  std::vector<unsigned char> binaryChunk() const {
    const FileBytes file(path_);
    const auto json = file.part(kGlbHeader, kChunkHeader);
    const std::uint64_t at = kGlbHeader + kChunkHeader + std::uint64_t{u32At(json, 0)};
    const auto chunk = file.part(at + kChunkHeader, u32At(file.part(at, kChunkHeader), 0));
    return {chunk.begin(), chunk.end()};
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
        auto read = valuesOf(accessor);
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

  bool dropSkins() {
    bool changed = json_.erase("skins") > 0;
    if (!json_.contains("nodes") || !json_["nodes"].is_array()) return changed;
    for (JsonValue& node : json_["nodes"]) changed |= node.is_object() && node.erase("skin") > 0;
    return changed;
  }

  const std::filesystem::path& path_;
  JsonValue json_;
  std::vector<float> floats_;  // of the accessors that are rewritten
  std::map<std::size_t, std::vector<unsigned char>> buffers_;
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
  if (gltf.altered) return "";
  const std::filesystem::path& path = gltf.path;
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
