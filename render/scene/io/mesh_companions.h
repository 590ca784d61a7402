// The files that a mesh names: materials, textures, buffers.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <map>
#include <string>
#include <vector>

namespace foci {

/// The files that a mesh names and that are there, each once: the material files of an OBJ and
/// their textures, the buffers and images of a glTF. Never fails: what cannot be read names none.
std::vector<std::filesystem::path> meshCompanions(const std::filesystem::path& mesh);

/// The names of the materials that the MTL files of an OBJ define. Empty if no file is there.
std::vector<std::string> definedMaterials(const std::filesystem::path& obj);

/// A texture with the options -s and -o: coordinates are multiplied by the scale, then moved.
struct MtlTexture {
  std::string name;
  glm::vec2 scale{1.0f}, offset{0.0f};
};

/// The textures of the colour (map_Kd) that the MTL files of an OBJ scale or move, by the name of
/// their material.
std::map<std::string, MtlTexture> placedTextures(const std::filesystem::path& obj);

}  // namespace foci
