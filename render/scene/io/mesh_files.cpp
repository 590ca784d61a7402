#include "render/scene/io/mesh_files.h"

#include <assimp/MemoryIOWrapper.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>
#include <utility>

#include "base/file.h"
#include "base/input_error.h"
#include "base/text.h"
#include "render/scene/io/gltf_json.h"
#include "render/scene/io/gltf_plain.h"
#include "render/scene/io/named_file.h"
#include "render/scene/io/obj_text.h"
#include "render/scene/io/stl_bytes.h"

namespace foci {
namespace {

constexpr std::array<std::string_view, 3> kCompressions = {
    "KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression"};

}  // namespace

std::string MeshFiles::fileOf(const char* name) const {
  std::error_code ignored;
  if (mesh_.empty() || !isGltf(mesh_) || std::filesystem::exists(name, ignored)) return name;
  const std::string text = name, folder = mesh_.parent_path().string();
  const std::size_t start = text.starts_with(folder) ? folder.size() : 0;
  return text.substr(0, start) + percentDecoded(std::string_view(text).substr(start));
}

bool MeshFiles::Exists(const char* name) const {
  std::error_code ignored;
  return std::filesystem::exists(fileOf(name), ignored);
}

Assimp::IOStream* MeshFiles::Open(const char* name, const char* mode) {
  const std::string file = fileOf(name);
  if (Exists(name)) requireRegularFile(file);
  Assimp::IOStream* stream =
      Exists(name) ? Assimp::DefaultIOSystem::Open(file.c_str(), mode) : nullptr;
  if (stream != nullptr && (mesh_.empty() || mesh_ == name)) {
    if (!mended_.text.empty()) {
      Close(stream);
      stream = new Assimp::MemoryIOStream(
          reinterpret_cast<const std::uint8_t*>(mended_.text.data()), mended_.text.size());
    }
  }
  if (mesh_.empty()) mesh_ = name;
  if (stream == nullptr) {
    const std::filesystem::path path = name;
    const bool second =
        !missing_.empty() && path.extension() == ".mtl" && path.stem() == mesh_.stem();
    const std::string bare = path.filename().string();
    const bool known = std::find(missing_.begin(), missing_.end(), bare) != missing_.end();
    if (!second && !known) missing_.push_back(bare);
  }
  return stream;
}

void MeshFiles::mend(const std::filesystem::path& mesh, std::optional<GltfDocument> gltf) {
  if (gltf) mended_.text = plainGltf(std::move(*gltf));
  if (lowerExtension(mesh) == ".obj") mended_ = readableObj(mesh);
  if (lowerExtension(mesh) == ".stl") mended_ = readableStl(mesh);
}

std::vector<std::string> MeshFiles::missing() const {
  std::vector<std::string> names;
  names.reserve(missing_.size());
  for (const std::string& name : missing_) names.push_back(shown(name));
  return names;
}

std::string compressionOf(const GltfDocument& gltf) {
  for (const std::string& name : requiredExtensions(gltf)) {
    if (std::find(kCompressions.begin(), kCompressions.end(), name) != kCompressions.end()) {
      return name;
    }
  }
  return "";
}

void refuseUnknownExtensions(const GltfDocument& gltf) {
  // Extensions that Assimp or gltf_plain.h reads, or that add to a picture which is right without
  // them.
  constexpr std::array<std::string_view, 7> kRead = {
      "KHR_texture_transform",  "KHR_mesh_quantization", "KHR_lights_punctual",
      "KHR_gaussian_splatting", "KHR_xmp_json_ld",       "EXT_texture_webp",
      "EXT_mesh_gpu_instancing"};
  for (const std::string& name : requiredExtensions(gltf)) {
    const auto is = [&](std::string_view known) { return name == known; };
    if (name.starts_with("KHR_materials_") || std::any_of(kRead.begin(), kRead.end(), is) ||
        std::any_of(kCompressions.begin(), kCompressions.end(), is)) {
      continue;
    }
    throw InputError(gltf.path.string(),
                     "requires the glTF extension " + shown(name) +
                         ", which foci cannot read: export it without, e.g. from "
                         "Blender");
  }
}

bool mayBeRead(const std::string& compression) {
  return compression.empty() || compression == kCompressions[0];
}

std::string compressionRefusal(const std::string& compression) {
  return "is compressed with " + compression +
         ", which foci cannot read: save it without compression, e.g. from Blender";
}

std::string compressionRemark(const std::string& compression) {
  if (compression.empty()) return "";
  return "; it is compressed with " + compression + ": try it without compression";
}

}  // namespace foci
