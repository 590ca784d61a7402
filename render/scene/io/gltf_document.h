// The JSON of a glTF file, parsed once for all that ask. Private to the readers of meshes.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace foci {

struct GltfDocument {
  std::filesystem::path path;
  nlohmann::json json;   ///< an object
  bool altered = false;  ///< bytes that are not UTF-8, as in Latin-1 names, became "?"
};

/// @throws InputError if the file cannot be read, is binary glTF of version 1, nests too deeply, or
/// is no JSON object
GltfDocument readGltf(const std::filesystem::path& path);

/// The names in the list "extensionsRequired".
std::vector<std::string> requiredExtensions(const GltfDocument& gltf);

}  // namespace foci
