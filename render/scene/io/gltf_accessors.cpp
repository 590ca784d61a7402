// glTF 2.0 (Khronos), section 3.6: buffers, views, accessors.
#include "render/scene/io/gltf_accessors.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <sstream>
#include <string>
#include <string_view>

#include "base/base64.h"
#include "base/input_error.h"
#include "base/text.h"
#include "render/scene/io/gaussian_file.h"
#include "render/scene/io/gltf_json.h"
#include "render/scene/io/named_file.h"

namespace foci {
namespace {

using JsonValue = nlohmann::json;

constexpr int kFloat = 5126;

/// Vectors of an accessor without a view, which takes memory that the file does not have.
constexpr std::size_t kMostSparse = std::size_t{1} << 22;

/// How a component is stored.
struct Component {
  std::size_t bytes;
  float most;  ///< of a normalised integer
  float (*read)(const unsigned char*);

  float at(const unsigned char* from, bool normalized) const {
    return normalized ? std::max(read(from) / most, -1.0f) : read(from);
  }
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

std::size_t componentsOf(std::string_view type) {
  if (type == "VEC2") return 2;
  if (type == "VEC3") return 3;
  if (type == "VEC4") return 4;
  return type == "MAT4" ? 16 : 1;
}

/// Bytes of an index: of an unsigned byte, short or integer.
std::size_t bytesOfIndex(std::size_t type) { return type == 5121 ? 1 : type == 5123 ? 2 : 4; }

std::size_t indexAt(const unsigned char* from, std::size_t bytes) {
  std::uint32_t index = 0;  // little-endian, as the machine
  std::memcpy(&index, from, bytes);
  return index;
}

/// Bytes from a record of a view to the next.
std::size_t strideOf(const JsonValue& view, std::size_t record) {
  return std::max(numberIn(view, "byteStride", record), record);
}

}  // namespace

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

bool GltfAccessors::isInteger(std::size_t number) const {
  const JsonValue* accessor = listEntry(json_, "accessors", number);
  if (accessor == nullptr) return false;
  const std::size_t type = numberIn(*accessor, "componentType", kFloat);
  return type != kFloat && componentOf(type);
}

std::optional<std::vector<float>> GltfAccessors::valuesOf(std::size_t number) {
  const JsonValue* const accessor = listEntry(json_, "accessors", number);
  const auto component =
      accessor ? componentOf(numberIn(*accessor, "componentType", 0)) : std::optional<Component>();
  if (!component) return std::nullopt;
  const std::size_t components = componentsOf(accessor->value("type", ""));
  const std::size_t count = numberIn(*accessor, "count", 0);
  const bool normalized = accessor->value("normalized", false);
  const auto sparse = accessor->find("sparse");
  std::vector<float> values;
  if (sparse != accessor->end() && !accessor->contains("bufferView")) {  // all others are zero
    if (count > kMostSparse) return std::nullopt;
    values.resize(count * components);
  } else {
    const std::size_t view = numberIn(*accessor, "bufferView", SIZE_MAX);
    const std::size_t record = components * component->bytes;
    const auto bytes = viewOf(number, view, numberIn(*accessor, "byteOffset", 0), count, record);
    if (!bytes) return std::nullopt;
    const std::size_t stride = strideOf(*listEntry(json_, "bufferViews", view), record);
    values.resize(count * components);
    for (std::size_t i = 0; i < values.size(); ++i) {
      const std::size_t at = i / components * stride + i % components * component->bytes;
      values[i] = component->at(bytes->data() + at, normalized);
    }
  }
  if (sparse == accessor->end()) return values;

  const JsonValue &indices = sparse->at("indices"), &news = sparse->at("values");
  const std::size_t changed = numberIn(*sparse, "count", 0);
  const std::size_t index_bytes = bytesOfIndex(numberIn(indices, "componentType", 0));
  const auto places = viewOf(number, numberIn(indices, "bufferView", SIZE_MAX),
                             numberIn(indices, "byteOffset", 0), changed, index_bytes);
  const auto bytes =
      viewOf(number, numberIn(news, "bufferView", SIZE_MAX), numberIn(news, "byteOffset", 0),
             changed, components * component->bytes);
  if (!places || !bytes) return std::nullopt;
  for (std::size_t i = 0; i < changed; ++i) {
    const std::size_t place = indexAt(places->data() + i * index_bytes, index_bytes);
    if (place >= count) {
      refuse(number,
             "changes its vector " + std::to_string(place) + " of " + std::to_string(count));
    }
    for (std::size_t c = 0; c < components; ++c) {
      const std::size_t at = (i * components + c) * component->bytes;
      values[place * components + c] = component->at(bytes->data() + at, normalized);
    }
  }
  return values;
}

std::optional<std::vector<unsigned char>> GltfAccessors::bytesOfView(std::size_t number) {
  const JsonValue* const view = listEntry(json_, "bufferViews", number);
  if (view == nullptr) return std::nullopt;
  const auto bytes = bufferOf(numberIn(*view, "buffer", SIZE_MAX));
  if (!bytes) return std::nullopt;
  const std::size_t at = numberIn(*view, "byteOffset", 0),
                    length = numberIn(*view, "byteLength", 0);
  if (at > bytes->size() || length > bytes->size() - at) {
    throw InputError(path_.string(), "view " + std::to_string(number) +
                                         " reaches beyond its buffer: is the file cut off?");
  }
  const Bytes part = bytes->subspan(at, length);
  return std::vector<unsigned char>(part.begin(), part.end());
}

void GltfAccessors::replace(std::size_t number, std::span<const float> values) {
  const std::size_t view = addView(values);
  JsonValue& accessor = json_["accessors"][number];
  accessor["bufferView"] = view;
  accessor["componentType"] = kFloat;
  for (const char* key : {"byteOffset", "normalized", "min", "max", "sparse"}) accessor.erase(key);
}

std::size_t GltfAccessors::add(std::span<const float> values) {
  json_["accessors"].push_back({{"bufferView", addView(values)},
                                {"componentType", kFloat},
                                {"count", values.size() / 3},
                                {"type", "VEC3"}});
  return json_["accessors"].size() - 1;
}

std::size_t GltfAccessors::addView(std::span<const float> values) {
  json_["bufferViews"].push_back({{"buffer", json_["buffers"].size()},
                                  {"byteOffset", floats_.size() * sizeof(float)},
                                  {"byteLength", values.size_bytes()}});
  floats_.insert(floats_.end(), values.begin(), values.end());
  return json_["bufferViews"].size() - 1;
}

bool GltfAccessors::finish() {
  if (floats_.empty()) return false;
  const std::size_t bytes = floats_.size() * sizeof(float);
  std::ostringstream uri;
  uri << "data:application/octet-stream;base64,";
  Base64 base64(uri);
  base64.add(reinterpret_cast<const std::uint8_t*>(floats_.data()), bytes);
  base64.finish();
  json_["buffers"].push_back({{"byteLength", bytes}, {"uri", uri.str()}});
  return true;
}

void GltfAccessors::refuse(std::size_t number, const std::string& why) const {
  throw InputError(path_.string(),
                   "accessor " + std::to_string(number) + ' ' + why + ": is the file cut off?");
}

/// The bytes of a view, from `offset` on.
/// @param count, record  records that it must have, and their bytes
std::optional<std::span<const unsigned char>> GltfAccessors::viewOf(std::size_t accessor,
                                                                    std::size_t number,
                                                                    std::size_t offset,
                                                                    std::size_t count,
                                                                    std::size_t record) {
  const JsonValue* const view = listEntry(json_, "bufferViews", number);
  if (view == nullptr) return std::nullopt;
  const auto bytes = bufferOf(numberIn(*view, "buffer", SIZE_MAX));
  if (!bytes) return std::nullopt;
  const std::size_t stride = strideOf(*view, record);
  const std::size_t start = numberIn(*view, "byteOffset", 0) + offset;
  const bool inside = start <= bytes->size() && bytes->size() - start >= record &&
                      (bytes->size() - start - record) / stride + 1 >= count;
  if (count > 0 && !inside) {
    refuse(accessor, "reaches beyond its buffer of " +
                         thousands(static_cast<double>(bytes->size())) + " bytes");
  }
  return bytes->subspan(std::min(start, bytes->size()));
}

std::optional<std::span<const unsigned char>> GltfAccessors::bufferOf(std::size_t number) {
  const JsonValue* const buffer = listEntry(json_, "buffers", number);
  if (buffer == nullptr) return std::nullopt;
  auto found = buffers_.find(number);
  if (found == buffers_.end()) {
    const std::string uri = buffer->value("uri", "");
    std::vector<unsigned char> bytes;
    if (uri.empty()) {
      bytes = binaryChunk();
    } else if (uri.starts_with("data:")) {
      bytes = bytesOfBase64(std::string_view(uri).substr(std::min(uri.find(',') + 1, uri.size())));
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
std::vector<unsigned char> GltfAccessors::binaryChunk() const {
  const FileBytes file(path_);
  const auto json = file.part(kGlbHeader, kChunkHeader);
  const std::uint64_t at = kGlbHeader + kChunkHeader + std::uint64_t{u32At(json, 0)};
  const auto chunk = file.part(at + kChunkHeader, u32At(file.part(at, kChunkHeader), 0));
  return {chunk.begin(), chunk.end()};
}

}  // namespace foci
