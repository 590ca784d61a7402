// How a material places its texture on a surface. Private to the readers of meshes.
#pragma once

#include <assimp/material.h>

#include <glm/glm.hpp>

namespace foci {

/// The set of texture coordinates, and what is done to these; v points upwards.
struct TexturePlacement {
  unsigned set = 0;
  glm::mat3 transform{1.0f};

  glm::vec2 of(const glm::vec2& uv) const { return glm::vec2(transform * glm::vec3(uv, 1.0f)); }
};

/// Coordinates are multiplied by the scale, then moved.
TexturePlacement shiftedPlacement(const glm::vec2& scale, const glm::vec2& offset);

/// Of the first texture of this type.
/// @param gltf  whether the material comes from a glTF file
TexturePlacement texturePlacement(const aiMaterial& material, aiTextureType type, bool gltf);

}  // namespace foci
