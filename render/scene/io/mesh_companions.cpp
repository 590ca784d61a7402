// Wavefront's OBJ and MTL; glTF 2.0 and 1.0 (Khronos).
#include "render/scene/io/mesh_companions.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "base/file.h"
#include "base/input_error.h"
#include "base/text.h"
#include "render/scene/io/gltf_document.h"
#include "render/scene/io/gltf_json.h"
#include "render/scene/io/named_file.h"
#include "render/scene/io/obj_text.h"

namespace foci {
namespace {

namespace fs = std::filesystem;

class Companions {
 public:
  explicit Companions(const fs::path& mesh) : folder_(mesh.parent_path()) {}

  void add(std::string name) {
    std::replace(name.begin(), name.end(), '\\', '/');
    const fs::path file = folder_ / name;
    std::error_code ignored;
    if (!fs::is_regular_file(file, ignored)) return;
    if (std::find(files_.begin(), files_.end(), file) == files_.end()) files_.push_back(file);
  }

  /// Calls `take` with the first word of each line, and with the rest.
  template <class Take>
  static void eachLine(const fs::path& file, const Take& take) {
    std::ifstream in(file, std::ios::binary);
    for (std::string line; std::getline(in, line);) {
      const std::string_view text = trimmed(line);
      const std::size_t end = std::min(text.find_first_of(" \t"), text.size());
      if (end < text.size()) take(text.substr(0, end), trimmed(text.substr(end)));
    }
  }

  void readObj(const fs::path& obj) {
    std::vector<fs::path> materials;
    eachLine(obj, [&](std::string_view word, std::string_view rest) {
      if (word == "mtllib") add(std::string(rest));
    });
    materials = files_;
    for (const fs::path& material : materials) {
      eachLine(material, [&](std::string_view word, std::string_view rest) {
        if (!word.starts_with("map_") && word != "bump" && word != "norm") return;
        add(std::string(rest));  // a name with blanks, or the last word, after options
        add(std::string(rest.substr(rest.find_last_of(" \t") + 1)));
      });
    }
  }

  void readGltf(const fs::path& gltf) {
    const nlohmann::json json = foci::readGltf(gltf).json;
    for (const char* list : {"buffers", "images"}) {
      for (const auto& entry : json.value(list, nlohmann::json::array())) {
        if (!entry.is_object() || !entry.contains("uri") || !entry.at("uri").is_string()) continue;
        const std::string uri = entry.at("uri").get<std::string>();
        if (uri.starts_with("data:")) continue;
        add(uri);
        add(percentDecoded(uri));
      }
    }
  }

  std::vector<fs::path> files() && { return std::move(files_); }

 private:
  fs::path folder_;
  std::vector<fs::path> files_;
};

/// Calls `take` as `Companions::eachLine`, for the MTL files of an OBJ.
template <class Take>
void eachMaterialLine(const fs::path& obj, const Take& take) {
  for (const fs::path& file : meshCompanions(obj)) {
    if (lowerExtension(file) == ".mtl") Companions::eachLine(file, take);
  }
}

std::optional<float> mtlNumber(std::string_view word) {
  float number = 0.0f;
  const char* const end = word.data() + word.size();
  const auto [read, error] = std::from_chars(word.data(), end, number);
  if (error != std::errc() || read != end) return std::nullopt;
  return number;
}

/// A texture in an MTL file: options, then its name, which may have blanks.
MtlTexture mtlTextureOf(std::string_view rest) {
  MtlTexture texture;
  while (rest.starts_with('-')) {
    const std::string_view option = nextObjWord(rest);
    const bool scales = option == "-s", moves = option == "-o";
    int numbers = 0;
    for (std::string_view after = rest; numbers < 3; ++numbers, rest = after) {
      const auto number = mtlNumber(nextObjWord(after));
      if (!number) break;
      if (scales && numbers < 2) texture.scale[numbers] = *number;
      if (moves && numbers < 2) texture.offset[numbers] = *number;
    }
    if (numbers == 0) nextObjWord(rest);  // on, off or another word
    rest = trimmed(rest);
  }
  texture.name = rest;
  return texture;
}

}  // namespace

std::vector<fs::path> meshCompanions(const fs::path& mesh) {
  Companions companions(mesh);
  std::error_code ignored;
  if (!fs::is_regular_file(mesh, ignored)) return {};
  try {
    if (isGltf(mesh)) {
      companions.readGltf(mesh);
    } else if (lowerExtension(mesh) == ".obj") {
      companions.readObj(mesh);
    }
  } catch (const InputError&) {  // opening the scene reports it
  }
  return std::move(companions).files();
}

std::vector<std::string> definedMaterials(const fs::path& obj) {
  std::vector<std::string> names;
  eachMaterialLine(obj, [&](std::string_view word, std::string_view rest) {
    if (word == "newmtl") names.emplace_back(rest);
  });
  return names;
}

std::map<std::string, MtlTexture> placedTextures(const fs::path& obj) {
  std::map<std::string, MtlTexture> textures;
  std::string material;
  eachMaterialLine(obj, [&](std::string_view word, std::string_view rest) {
    if (word == "newmtl") material = rest;
    if (word != "map_Kd") return;
    MtlTexture texture = mtlTextureOf(rest);
    if (texture.scale != glm::vec2(1.0f) || texture.offset != glm::vec2(0.0f)) {
      textures[material] = std::move(texture);
    }
  });
  return textures;
}

}  // namespace foci
