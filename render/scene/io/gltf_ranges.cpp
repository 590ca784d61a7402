// glTF 2.0 (Khronos), section 3.6; glTF 1.0, where the parts have names and accessors the stride.
#include "render/scene/io/gltf_ranges.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "base/base64.h"
#include "base/input_error.h"
#include "base/text.h"
#include "render/scene/io/gltf_json.h"
#include "render/scene/io/named_file.h"

namespace foci {
namespace {

using Json = nlohmann::json;

constexpr std::uint64_t kLargest = std::uint64_t{1} << 48;  // sums and products stay in 64 bits

std::string bytesText(std::uint64_t bytes) {
  return thousands(static_cast<double>(bytes)) + " bytes";
}

class GltfRanges {
 public:
  explicit GltfRanges(const GltfDocument& gltf) : path_(gltf.path), json_(gltf.json) {
    for (const auto& [key, buffer] : partsOf("buffers")) buffers_[buffer] = bytesOfBuffer(*buffer);
  }

  /// @throws InputError
  void check() const {
    for (const auto& [key, view] : partsOf("bufferViews")) checkView(key, *view);
    for (const auto& [key, accessor] : partsOf("accessors")) checkAccessor(key, *accessor);
    for (const auto& [key, mesh] : partsOf("meshes")) checkMesh(key, *mesh);
    for (const auto& [key, animation] : partsOf("animations")) checkAnimation(key, *animation);
  }

 private:
  /// The parts of a list by number, or by name; only those that are objects.
  std::map<std::string, const Json*> partsOf(const char* list) const {
    std::map<std::string, const Json*> parts;
    const auto found = json_.find(list);
    if (found == json_.end() || !found->is_structured()) return parts;
    for (const auto& [key, part] : found->items()) {
      if (part.is_object()) parts.emplace(key, &part);
    }
    return parts;
  }

  /// The part that `object` refers to; null if there is none.
  const Json* partAt(const char* list, const Json& object, const char* key) const {
    const auto parts = json_.find(list);
    const auto reference = object.find(key);
    if (parts == json_.end() || reference == object.end()) return nullptr;
    const Json* part = nullptr;
    if (parts->is_array() && reference->is_number_unsigned()) {
      const auto number = reference->get<std::uint64_t>();
      if (number < parts->size()) part = &(*parts)[number];
    } else if (parts->is_object() && reference->is_string()) {
      const auto found = parts->find(reference->get<std::string>());
      if (found != parts->end()) part = &*found;
    }
    return part != nullptr && part->is_object() ? part : nullptr;
  }

  [[noreturn]] void refuse(const std::string& what, const std::string& why) const {
    throw InputError(path_.string(), what + " " + why +
                                         ": is the file cut off? else export it "
                                         "again");
  }

  std::uint64_t sizeIn(const std::string& what, const Json& object, const char* key,
                       std::uint64_t otherwise) const {
    const auto found = object.find(key);
    if (found == object.end()) return otherwise;
    if (found->is_number_unsigned() && found->get<std::uint64_t>() <= kLargest) {
      return found->get<std::uint64_t>();
    }
    refuse(what, "has " + std::string(key) + " = " + found->dump().substr(0, 40) +
                     ", which is no number of bytes or elements");
  }

  /// Bytes of a buffer that are there.
  std::uint64_t bytesOfBuffer(const Json& buffer) const {
    const std::uint64_t stated = sizeIn("a buffer", buffer, "byteLength", 0);
    const auto uri = buffer.find("uri");
    if (uri == buffer.end() || !uri->is_string()) return std::min(stated, bytesOfChunk());
    const auto& text = uri->get_ref<const std::string&>();
    if (text.starts_with("data:")) {
      const std::size_t comma = std::min(text.find(','), text.size());
      const std::string_view data = std::string_view(text).substr(comma);
      const bool base64 = std::string_view(text).substr(0, comma).ends_with(";base64");
      return std::min<std::uint64_t>(stated, base64 ? bytesOfBase64(data).size() : data.size());
    }
    std::error_code error;
    const auto size = std::filesystem::file_size(path_.parent_path() / percentDecoded(text), error);
    return error ? stated : std::min<std::uint64_t>(stated, size);
  }

  /// Of a binary file, after the chunk of the JSON; 0 in a text file.
  std::uint64_t bytesOfChunk() const {
    std::ifstream in(path_, std::ios::binary);
    std::array<std::uint32_t, 5> header{};  // little-endian, as the machine
    if (!in.read(reinterpret_cast<char*>(header.data()), sizeof(header)) ||
        std::memcmp(header.data(), "glTF", 4) != 0) {
      return 0;
    }
    std::uint32_t bytes = 0;
    in.seekg(static_cast<std::streamoff>(kGlbHeader + kChunkHeader + std::uint64_t{header[3]}));
    return in.read(reinterpret_cast<char*>(&bytes), sizeof(bytes)) ? bytes : 0;
  }

  std::uint64_t bytesOfView(const std::string& what, const Json& view) const {
    const Json* const buffer = partAt("buffers", view, "buffer");
    const std::uint64_t all = buffer != nullptr ? buffers_.at(buffer) : 0;
    const std::uint64_t offset = sizeIn(what, view, "byteOffset", 0);
    const std::uint64_t length = sizeIn(what, view, "byteLength", all > offset ? all - offset : 0);
    if (offset > all || length > all - offset) {
      refuse(what, "reaches beyond its buffer of " + bytesText(all));
    }
    return length;
  }

  void checkView(const std::string& key, const Json& view) const {
    if (partAt("buffers", view, "buffer") != nullptr) bytesOfView("view " + key, view);
  }

  static std::uint64_t bytesOfComponent(std::uint64_t type) {
    return type == 5120 || type == 5121 ? 1 : type == 5122 || type == 5123 ? 2 : 4;
  }

  static std::uint64_t componentsOf(const Json& accessor) {
    constexpr std::array<std::pair<std::string_view, std::uint64_t>, 6> kTypes = {
        {{"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}, {"MAT3", 9}, {"MAT4", 16}}};
    const auto type = accessor.find("type");
    if (type == accessor.end() || !type->is_string()) return 1;
    for (const auto& [name, count] : kTypes) {
      if (type->get_ref<const std::string&>() == name) return count;
    }
    return 1;
  }

  /// `count` records of `record` bytes, as `object` places them in its view.
  void checkPlace(const std::string& what, const Json& object, std::uint64_t count,
                  std::uint64_t record) const {
    const Json* const view = partAt("bufferViews", object, "bufferView");
    if (view == nullptr || count == 0) return;
    const std::uint64_t bytes = bytesOfView("the view of " + what, *view);
    const std::uint64_t offset = sizeIn(what, object, "byteOffset", 0);
    const std::uint64_t stride = std::max(
        {sizeIn(what, *view, "byteStride", 0), sizeIn(what, object, "byteStride", 0), record});
    const bool inside = offset <= bytes && bytes - offset >= record &&
                        (bytes - offset - record) / stride + 1 >= count;
    if (!inside) refuse(what, "reaches beyond its view of " + bytesText(bytes));
  }

  void checkAccessor(const std::string& key, const Json& accessor) const {
    const std::string what = "accessor " + key;
    const std::uint64_t count = sizeIn(what, accessor, "count", 0);
    const std::uint64_t record =
        componentsOf(accessor) * bytesOfComponent(sizeIn(what, accessor, "componentType", 0));
    checkPlace(what, accessor, count, record);
    const auto sparse = accessor.find("sparse");
    if (sparse == accessor.end() || !sparse->is_object()) return;
    const std::uint64_t changed = sizeIn(what, *sparse, "count", 0);
    if (changed > count) refuse(what, "changes more elements than it has");
    for (const char* part : {"indices", "values"}) {
      const auto place = sparse->find(part);
      if (place == sparse->end() || !place->is_object()) continue;
      const std::uint64_t type = sizeIn(what, *place, "componentType", 0);
      checkPlace(what, *place, changed, place.key() == "values" ? record : bytesOfComponent(type));
    }
  }

  std::optional<std::uint64_t> countAt(const Json& object, const char* key) const {
    const Json* const accessor = partAt("accessors", object, key);
    if (accessor == nullptr) return std::nullopt;
    return sizeIn("an accessor", *accessor, "count", 0);
  }

  void checkAttributes(const std::string& what, const Json& attributes,
                       std::uint64_t vertices) const {
    if (!attributes.is_object()) return;
    for (const auto& [name, reference] : attributes.items()) {
      const auto count = countAt(attributes, name.c_str());
      if (!count || *count == vertices) continue;
      refuse(what, "has " + thousands(static_cast<double>(vertices)) + " positions and " +
                       thousands(static_cast<double>(*count)) + " of " + shown(name));
    }
  }

  void checkMesh(const std::string& key, const Json& mesh) const {
    const auto primitives = mesh.find("primitives");
    if (primitives == mesh.end() || !primitives->is_array()) return;
    for (const Json& primitive : *primitives) {
      if (!primitive.is_object() || !primitive.contains("attributes")) continue;
      const Json& attributes = primitive.at("attributes");
      const auto vertices = attributes.is_object() ? countAt(attributes, "POSITION") : std::nullopt;
      if (!vertices) continue;
      checkAttributes("mesh " + key, attributes, *vertices);
      const auto targets = primitive.find("targets");
      if (targets == primitive.end() || !targets->is_array()) continue;
      for (const Json& target : *targets) checkAttributes("mesh " + key, target, *vertices);
    }
  }

  void checkAnimation(const std::string& key, const Json& animation) const {
    const auto samplers = animation.find("samplers");
    if (samplers == animation.end() || !samplers->is_array()) return;
    for (const Json& sampler : *samplers) {
      if (!sampler.is_object()) continue;
      const auto keys = countAt(sampler, "input"), values = countAt(sampler, "output");
      const bool cubic = sampler.value("interpolation", Json()) == "CUBICSPLINE";
      if (!keys || !values || *values >= (cubic ? 3 : 1) * *keys) continue;
      refuse("animation " + key, "has fewer values than times");
    }
  }

  const std::filesystem::path& path_;
  const Json& json_;
  std::map<const Json*, std::uint64_t> buffers_;  // bytes of each
};

}  // namespace

void refuseOverreachingGltf(const GltfDocument& gltf) { GltfRanges(gltf).check(); }

}  // namespace foci
