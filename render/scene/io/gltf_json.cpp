#include "render/scene/io/gltf_json.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <fstream>

#include "base/file.h"
#include "base/input_error.h"
#include "base/text.h"

namespace foci {

bool isGltf(const std::filesystem::path& path) {
  const std::string extension = lowerExtension(path);
  return extension == ".gltf" || extension == ".glb";
}

std::string gltfJson(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::array<std::uint32_t, 5> header{};  // little-endian, as the machine
  in.read(reinterpret_cast<char*>(header.data()), sizeof(header));
  const bool binary = in.gcount() >= 4 && std::memcmp(header.data(), "glTF", 4) == 0;
  std::error_code error;
  const std::uintmax_t file_bytes = std::filesystem::file_size(path, error);
  if (error) throw InputError(path.string(), "cannot be read");
  if (binary && header[1] == 1) {
    throw InputError(path.string(),
                     "is binary glTF of version 1: expected version 2, which Blender or "
                     "gltf-pipeline makes of it");
  }
  if (binary && header[2] > file_bytes) {
    throw InputError(path.string(), "is cut off: states " + thousands(header[2]) +
                                        " bytes, and has " +
                                        thousands(static_cast<double>(file_bytes)));
  }
  if (binary != (lowerExtension(path) == ".glb")) {
    throw InputError(path.string(), binary ? "is binary glTF: give it a name that ends in .glb"
                                           : "is no binary glTF: if it is glTF as text, give it a "
                                             "name that ends in .gltf");
  }
  // Version, length of the file, length of the JSON, kind of the chunk.
  const std::uintmax_t json_bytes =
      binary ? std::min<std::uintmax_t>(header[3], file_bytes) : file_bytes;
  in.clear();
  in.seekg(binary ? static_cast<std::streamoff>(sizeof(header)) : 0);
  std::string text(static_cast<std::size_t>(json_bytes), '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  return text;
}

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

}  // namespace foci
