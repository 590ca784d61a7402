// Wavefront's OBJ and MTL; glTF 2.0 and 1.0 (Khronos).
#include "render/scene/io/mesh_companions.h"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "base/file.h"
#include "base/input_error.h"
#include "base/text.h"
#include "render/scene/io/gltf_json.h"

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
    using Json = nlohmann::json;
    const auto wanted = [](int depth, Json::parse_event_t event, const Json& value) {
      return depth != 1 || event != Json::parse_event_t::key || value == "buffers" ||
             value == "images";
    };
    const Json json = Json::parse(gltfJson(gltf), wanted, /*allow_exceptions=*/false);
    if (!json.is_object()) return;
    for (const auto& [list, entries] : json.items()) {
      for (const Json& entry : entries) {
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
  for (const fs::path& file : meshCompanions(obj)) {
    if (lowerExtension(file) != ".mtl") continue;
    Companions::eachLine(file, [&](std::string_view word, std::string_view rest) {
      if (word == "newmtl") names.emplace_back(rest);
    });
  }
  return names;
}

}  // namespace foci
