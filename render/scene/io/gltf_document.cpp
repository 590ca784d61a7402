// glTF 2.0 (Khronos), sections 3.6 (buffers, views, accessors) and 4 (binary files).
#include "render/scene/io/gltf_document.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <string_view>
#include <utility>

#include "base/base64.h"
#include "base/input_error.h"
#include "render/scene/io/compression.h"
#include "render/scene/io/file_bytes.h"
#include "render/scene/io/mesh_files.h"

namespace foci {
namespace {

using Json = nlohmann::json;

constexpr int kMaxJsonDepth = 100;  // chosen by hand: exporters nest about 10 deep
constexpr std::size_t kLargest = std::size_t{1} << 48;  // sums and products stay in 64 bits
constexpr std::size_t kGlbHeader = 12, kChunkHeader = 8;

constexpr std::array<std::string_view, 2> kMeshopt = {"EXT_meshopt_compression",
                                                      "KHR_meshopt_compression"};

/// How deep the brackets of a JSON text nest, whether or not it is well formed.
int jsonDepth(std::string_view json) {
  int depth = 0, deepest = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (quoted && c == '\\') {
      ++i;
    } else if (c == '"') {
      quoted = !quoted;
    } else if (!quoted && (c == '{' || c == '[')) {
      deepest = std::max(deepest, ++depth);
    } else if (!quoted && (c == '}' || c == ']')) {
      --depth;
    }
  }
  return deepest;
}

std::string bytesText(std::size_t bytes) {
  return thousands(static_cast<double>(bytes)) + " bytes";
}

std::size_t bytesOfComponent(std::size_t type) {
  return type == 5120 || type == 5121 ? 1 : type == 5122 || type == 5123 ? 2 : 4;
}

template <class From, class To>
To numberAt(const unsigned char* bytes, bool normalized) {
  From value;
  std::memcpy(&value, bytes, sizeof(From));
  if (!normalized) return static_cast<To>(value);
  const float unit =
      static_cast<float>(value) / static_cast<float>(std::numeric_limits<From>::max());
  return static_cast<To>(std::max(unit, -1.0f));
}

template <class To>
using ReadNumber = To (*)(const unsigned char*, bool);

/// Null for a type that is none, and for floats as integers.
template <class To>
ReadNumber<To> readerOf(std::size_t type) {
  constexpr std::size_t kFirst = 5120;
  constexpr std::array<ReadNumber<To>, 7> kReaders = {
      numberAt<std::int8_t, To>,
      numberAt<std::uint8_t, To>,
      numberAt<std::int16_t, To>,
      numberAt<std::uint16_t, To>,
      nullptr,
      numberAt<std::uint32_t, To>,
      std::is_same_v<To, float> ? numberAt<float, To> : nullptr};
  return type >= kFirst && type < kFirst + kReaders.size() ? kReaders[type - kFirst] : nullptr;
}

/// Null if there is none.
const Json* memberOf(const Json& object, const char* key) {
  if (!object.is_object()) return nullptr;
  const auto found = object.find(key);
  return found == object.end() ? nullptr : &*found;
}

}  // namespace

/// Records inside a view, which reach no farther than it.
struct GltfDocument::Records {
  const unsigned char* first = nullptr;
  std::size_t stride = 0;
};

std::size_t numberIn(const GltfDocument& gltf, const Json& object, const char* key,
                     std::size_t otherwise) {
  const Json* const found = memberOf(object, key);
  if (found == nullptr) return otherwise;
  if (found->is_number_unsigned() && found->get<std::size_t>() <= kLargest) {
    return found->get<std::size_t>();
  }
  gltf.refuse(key, " = ", found->dump().substr(0, 40),
              " is no number of bytes, elements or an entry");
}

const Json& arrayIn(const Json& object, const char* key) {
  static const Json kEmpty = Json::array();
  const Json* const found = memberOf(object, key);
  return found != nullptr && found->is_array() ? *found : kEmpty;
}

const Json* partOf(const Json& object, const char* key) {
  const Json* const found = memberOf(object, key);
  return found != nullptr && found->is_object() ? found : nullptr;
}

std::optional<std::string> textIn(const Json& object, const char* key) {
  const Json* const found = memberOf(object, key);
  return found != nullptr && found->is_string() ? std::optional(found->get<std::string>())
                                                : std::nullopt;
}

double fractionIn(const Json& object, const char* key, double otherwise) {
  const Json* const found = memberOf(object, key);
  return found != nullptr && found->is_number() ? found->get<double>() : otherwise;
}

const Json* extensionOf(const Json& object, const char* name) {
  const Json* const all = partOf(object, "extensions");
  return all != nullptr ? partOf(*all, name) : nullptr;
}

GltfDocument::GltfDocument(const std::filesystem::path& path)
    : path_(path), file_(path), budget_(path) {
  parse(file_.bytes());
  checkExtensions();
}

void GltfDocument::refuseFor(const std::string& what) const {
  throw InputError(path_.string(), what,
                   (compression_.empty() ? ""
                                         : "; it is compressed with " + compression_ +
                                               ": try it without compression"));
}

void GltfDocument::refuseVersion(const std::string& version) const {
  refuse("is glTF of version ", version,
         ": expected version 2, which Blender or gltf-pipeline makes of it");
}

void GltfDocument::parse(Bytes file) {
  const bool binary = file.size() >= 4 && std::memcmp(file.data(), "glTF", 4) == 0;
  if (binary && file.size() >= kGlbHeader && u32At(file, 4) != 2) {
    refuseVersion(std::to_string(u32At(file, 4)));
  }
  if (binary && file.size() >= kGlbHeader && u32At(file, 8) > file.size()) {
    refuse("is cut off: states ", bytesText(u32At(file, 8)), ", and has ",
           thousands(static_cast<double>(file.size())));
  }
  Bytes text = file;
  if (binary) {
    text = {};
    for (std::size_t at = kGlbHeader; file.size() - std::min(at, file.size()) >= kChunkHeader;) {
      const std::size_t bytes = u32At(file, at), begin = at + kChunkHeader;
      const Bytes chunk = file.subspan(begin, std::min(bytes, file.size() - begin));
      if (at == kGlbHeader) {
        text = chunk;
      } else if (std::memcmp(&file[at + 4], "BIN", 4) == 0) {
        chunk_ = chunk;
        break;
      }
      at = begin + bytes;
    }
  }
  std::string_view json(reinterpret_cast<const char*>(text.data()), text.size());
  if (const int depth = jsonDepth(json); depth > kMaxJsonDepth) {
    refuse("its JSON nests ", depth, " deep: expected at most ", kMaxJsonDepth);
  }
  while (json.ends_with('\0')) json.remove_suffix(1);
  json_ = Json::parse(json, nullptr, /*allow_exceptions=*/false);  // skips a byte order mark
  if (json_.is_discarded()) {
    std::string ascii(json);
    std::ranges::replace_if(
        ascii, [](char c) { return static_cast<unsigned char>(c) >= 0x80; }, '?');
    json_ = Json::parse(ascii, nullptr, false);
  }
  if (!json_.is_object()) refuse("is not glTF: expected a JSON object");
  const Json* const asset = partOf(json_, "asset");
  const auto version = asset != nullptr ? textIn(*asset, "version") : std::nullopt;
  if (version && !version->starts_with("2")) refuseVersion(shown(*version));
  if (partOf(json_, "nodes") != nullptr) refuseVersion("1");
}

/// Refuses extensions without which the image would be wrong.
void GltfDocument::checkExtensions() {
  constexpr std::array<std::string_view, 10> kRead = {
      "KHR_texture_transform", "KHR_mesh_quantization",   "KHR_lights_punctual", "KHR_xmp_json_ld",
      "EXT_texture_webp",      "EXT_mesh_gpu_instancing", "KHR_texture_basisu",  "EXT_texture_avif",
      "MSFT_texture_dds",      "KHR_node_visibility"};
  for (const Json& each : arrayIn(json_, "extensionsRequired")) {
    if (!each.is_string()) continue;
    const auto name = each.get<std::string>();
    if (name.starts_with("KHR_gaussian_splatting")) continue;
    const auto is = [&](std::string_view known) { return name == known; };
    const bool compressed =
        name == "KHR_draco_mesh_compression" || std::ranges::any_of(kMeshopt, is);
    if (readsCompressed() && compressed) {
      compression_ = name;
    } else if (!name.starts_with("KHR_materials_") && std::ranges::none_of(kRead, is)) {
      refuse("requires the glTF extension ", shown(name),
             ", which foci cannot read: export it without, e.g. from Blender");
    }
  }
}

const Json* GltfDocument::entry(const char* list, std::size_t number) const {
  const Json& all = arrayIn(json_, list);
  return number < all.size() && all[number].is_object() ? &all[number] : nullptr;
}

const Json* GltfDocument::entry(const char* list, const Json& object, const char* key) const {
  return entry(list, numberIn(*this, object, key, kNoEntry));
}

const Json& GltfDocument::accessorAt(std::size_t number) const {
  const Json* const accessor = entry("accessors", number);
  if (accessor == nullptr) refuse("has no accessor ", number);
  return *accessor;
}

std::size_t GltfDocument::countOf(std::size_t accessor) const {
  return numberIn(*this, accessorAt(accessor), "count", 0);
}

std::size_t GltfDocument::componentsOf(std::size_t accessor) const {
  constexpr std::pair<std::string_view, std::size_t> kTypes[] = {
      {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}, {"MAT3", 9}, {"MAT4", 16}};
  const Json type = accessorAt(accessor).value("type", Json());
  for (const auto& [name, count] : kTypes) {
    if (type == name) return count;
  }
  refuse("accessor ", accessor, " has the type ", type.dump().substr(0, 40));
}

std::optional<std::vector<unsigned char>> GltfDocument::dataOf(const std::string& uri) {
  if (!uri.starts_with("data:")) return std::nullopt;
  const std::size_t comma = std::min(uri.find(','), uri.size() - 1);
  const std::string_view data = std::string_view(uri).substr(comma + 1);
  if (std::string_view(uri).substr(0, comma).ends_with(";base64")) return bytesOfBase64(data);
  const std::string plain = percentDecoded(data);
  return std::vector<unsigned char>(plain.begin(), plain.end());
}

/// As many of the bytes that a buffer states as are there.
GltfDocument::Bytes GltfDocument::buffer(std::size_t number) const {
  if (const auto known = buffers_.find(number); known != buffers_.end()) return known->second;
  const Json* const buffer = entry("buffers", number);
  if (buffer == nullptr) refuse("has no buffer ", number);
  Bytes bytes = chunk_;
  if (const auto uri = textIn(*buffer, "uri")) {
    if (auto data = dataOf(*uri)) {
      bytes = unpacked_[number] = std::move(*data);
    } else {
      const auto file = fileOfUri(path_, *uri);
      if (!file) refuse("its buffer ", shown(*uri), " is missing: put that file beside it");
      requireRegularFile(*file);
      budget_.addFile(*file);
      bytes = files_.emplace_back(std::make_unique<MappedFile>(*file))->bytes();
    }
  }
  bytes = bytes.first(std::min(bytes.size(), numberIn(*this, *buffer, "byteLength", 0)));
  return buffers_[number] = bytes;
}

/// The part of a buffer that a view, or a compressed view, states.
GltfDocument::Bytes GltfDocument::slice(const std::string& what, const Json& object) const {
  const Bytes all = buffer(numberIn(*this, object, "buffer", kNoEntry));
  const std::size_t offset = numberIn(*this, object, "byteOffset", 0);
  const std::size_t length = numberIn(*this, object, "byteLength", 0);
  if (offset > all.size() || length > all.size() - offset) {
    refuse(what, " reaches beyond its buffer of ", bytesText(all.size()),
           ": is the file cut off? else export it again");
  }
  return all.subspan(offset, length);
}

GltfDocument::Bytes GltfDocument::view(std::size_t number) const {
  if (const auto known = decoded_.find(number); known != decoded_.end()) return known->second;
  const std::string what = "view " + std::to_string(number);
  const Json* const view = entry("bufferViews", number);
  if (view == nullptr) refuse("has no view ", number);
  for (const std::string_view name : kMeshopt) {
    const Json* const packed = extensionOf(*view, name.data());
    if (packed == nullptr) continue;
    const std::size_t count = numberIn(*this, *packed, "count", 0),
                      stride = numberIn(*this, *packed, "byteStride", 0);
    budget_.take(count, stride, "its compressed views");
    std::vector<unsigned char> bytes(count * stride);
    const MeshoptView meshopt{.mode = packed->value("mode", ""),
                              .filter = packed->value("filter", "NONE"),
                              .count = count,
                              .stride = stride};
    if (!decodeMeshopt(meshopt, slice(what, *packed), bytes)) {
      refuse(what, " of ", name, " cannot be decoded: save it without compression");
    }
    return decoded_[number] = std::move(bytes);
  }
  return slice(what, *view);
}

GltfDocument::Records GltfDocument::recordsOf(const std::string& what, const Json& object,
                                              std::size_t count, std::size_t components,
                                              std::size_t type) const {
  const std::size_t number = numberIn(*this, object, "bufferView", kNoEntry);
  const Bytes bytes = view(number);
  const std::size_t offset = numberIn(*this, object, "byteOffset", 0);
  const std::size_t record = components * bytesOfComponent(type);
  const std::size_t stride =
      std::max(numberIn(*this, *entry("bufferViews", number), "byteStride", record), record);
  const bool inside = offset <= bytes.size() && bytes.size() - offset >= record &&
                      (bytes.size() - offset - record) / stride + 1 >= count;
  if (count > 0 && !inside) {
    refuse(what, " reaches beyond its view of ", bytesText(bytes.size()),
           ": is the file cut off? else export it again");
  }
  return {bytes.data() + offset, stride};
}

template <class To>
std::vector<To> GltfDocument::values(std::size_t number, std::size_t components,
                                     bool as_unit) const {
  const Json& accessor = accessorAt(number);
  const std::string what = "accessor " + std::to_string(number);
  const std::size_t count = countOf(number), type = numberIn(*this, accessor, "componentType", 0);
  const ReadNumber<To> read = readerOf<To>(type);
  if (read == nullptr || componentsOf(number) != components) {
    refuse(what, " has components of the type ", type, ", ", componentsOf(number),
           " each: expected ", components, (std::is_same_v<To, float> ? " numbers" : " integer"));
  }
  const bool normalized = (as_unit || accessor.value("normalized", Json()) == true) && type != 5126;
  const std::size_t bytes = bytesOfComponent(type);
  std::vector<To> values;
  if (accessor.contains("bufferView")) {
    const Records from = recordsOf(what, accessor, count, components, type);
    values.resize(count * components);
    To* to = values.data();
    for (std::size_t i = 0; i < count; ++i) {
      const unsigned char* record = from.first + i * from.stride;
      for (std::size_t c = 0; c < components; ++c) *to++ = read(record + c * bytes, normalized);
    }
  } else {
    budget_.take(count, components * sizeof(To), what);
    values.resize(count * components);
  }
  const auto sparse = accessor.find("sparse");
  if (sparse == accessor.end() || !sparse->is_object()) return values;

  const Json indices = sparse->value("indices", Json()), news = sparse->value("values", Json());
  const std::size_t changed = numberIn(*this, *sparse, "count", 0);
  const std::size_t index_type = numberIn(*this, indices, "componentType", 0);
  const auto read_index = readerOf<std::uint32_t>(index_type);
  if (read_index == nullptr || changed > count) refuse(what, " has no valid sparse elements");
  const Records places = recordsOf(what, indices, changed, 1, index_type);
  const Records from = recordsOf(what, news, changed, components, type);
  for (std::size_t i = 0; i < changed; ++i) {
    const std::size_t place = read_index(places.first + i * places.stride, false);
    if (place >= count) {
      refuse(what, " changes its record ", place, " of ", count, ": is the file cut off?");
    }
    for (std::size_t c = 0; c < components; ++c) {
      values[place * components + c] = read(from.first + i * from.stride + c * bytes, normalized);
    }
  }
  return values;
}

std::vector<float> GltfDocument::floats(std::size_t accessor, std::size_t components,
                                        bool as_unit) const {
  return values<float>(accessor, components, as_unit);
}

std::vector<std::uint32_t> GltfDocument::integers(std::size_t accessor) const {
  return values<std::uint32_t>(accessor, 1, false);
}

}  // namespace foci
