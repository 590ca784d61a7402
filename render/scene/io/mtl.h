// Wavefront's MTL. Private to the reader of OBJ.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "render/scene/io/mesh_textures.h"

namespace foci {

/// A texture with its options. Coordinates are multiplied by the scale (-s), then moved (-o).
struct MtlTexture {
  ImageSource source{};
  glm::vec2 scale{1.0f}, offset{0.0f};
  bool clamped = false;
};

struct MtlMaterial {
  std::string name{};
  std::optional<glm::vec3> diffuse{};                     ///< Kd, sRGB
  glm::vec3 emitted{0.0f};                                ///< Ke, sRGB
  std::optional<float> opacity{};                         ///< d
  std::optional<float> transparency{};                    ///< Tr
  std::optional<MtlTexture> color{}, emission{}, mask{};  ///< map_Kd, map_Ke, map_d
};

struct MtlFile {
  std::vector<MtlMaterial> materials{};
  std::vector<std::filesystem::path> textures{};  ///< all that it names and that are there
};

/// @param obj  the mesh: textures may lie beside it, too
MtlFile readMtl(const std::filesystem::path& mtl, const std::filesystem::path& obj);

}  // namespace foci
