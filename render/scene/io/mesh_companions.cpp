#include "render/scene/io/mesh_companions.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "base/file.h"
#include "base/input_error.h"
#include "render/scene/io/gltf_document.h"
#include "render/scene/io/mtl.h"
#include "render/scene/io/named_file.h"
#include "render/scene/io/obj.h"
#include "render/scene/io/ply_items.h"

namespace foci {
namespace {

namespace fs = std::filesystem;

class Companions {
 public:
  explicit Companions(const fs::path& mesh) : mesh_(mesh) {}

  std::vector<fs::path> files() {
    const std::string extension = lowerExtension(mesh_);
    if (extension == ".gltf" || extension == ".glb") {
      readGltf();
    } else if (extension == ".obj") {
      readObj();
    } else if (extension == ".ply") {
      ply::Input input(mesh_);
      for (const std::string& name : ply::textureNames(ply::readHeader(input))) {
        add(namedFile(mesh_, name));
      }
    }
    return std::move(files_);
  }

 private:
  void add(const std::optional<fs::path>& file) {
    if (file && std::find(files_.begin(), files_.end(), *file) == files_.end()) {
      files_.push_back(*file);
    }
  }

  void readObj() {
    for (const fs::path& library : librariesOf(mesh_, libraryNames(mesh_))) {
      add(library);
      for (const fs::path& texture : readMtl(library, mesh_).textures) add(texture);
    }
  }

  void readGltf() {
    const GltfDocument gltf(mesh_);
    for (const char* list : {"buffers", "images"}) {
      for (const auto& entry : arrayIn(gltf.json(), list)) {
        if (!entry.is_object() || !entry.contains("uri") || !entry.at("uri").is_string()) continue;
        const std::string uri = entry.at("uri").get<std::string>();
        if (uri.starts_with("data:")) continue;
        const auto file = namedFile(mesh_, uri);
        add(file ? file : namedFile(mesh_, percentDecoded(uri)));
      }
    }
  }

  fs::path mesh_;
  std::vector<fs::path> files_;
};

}  // namespace

std::vector<fs::path> meshCompanions(const fs::path& mesh) {
  std::error_code ignored;
  if (!fs::is_regular_file(mesh, ignored)) return {};
  try {
    return Companions(mesh).files();
  } catch (const InputError&) {  // opening the scene reports it
    return {};
  }
}

}  // namespace foci
