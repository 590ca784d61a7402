// The materials of a glTF. Private to its reader.
#pragma once

#include <cstddef>
#include <deque>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "render/scene/io/gltf_document.h"
#include "render/scene/io/mesh_builder.h"

namespace foci {

class GltfMaterials {
 public:
  /// @param builder  reads the textures; has to stay, as the document
  GltfMaterials(const GltfDocument& gltf, MeshBuilder& builder);

  /// The number of a primitive's material; that of a plain one if it names none.
  std::uint32_t numberOf(const nlohmann::json& primitive) const;

  /// How a material places the texture of its colour: the set of texture coordinates, and what is
  /// done to these, whose v points downwards.
  struct Placement {
    std::size_t set = 0;
    glm::mat3 transform{1.0f};
    bool glows = false;  ///< the material is black but for the light that it emits

    /// The result's v points upwards.
    glm::vec2 of(const glm::vec2& uv) const {
      const glm::vec3 placed = transform * glm::vec3(uv, 1.0f);
      return {placed.x, 1.0f - placed.y};
    }
  };
  Placement placementOf(std::uint32_t material) const;

  ReadMaterial read(std::uint32_t material);

 private:
  struct Color;

  Color colorOf(const nlohmann::json& material) const;
  ImageSource imageOf(const nlohmann::json& texture);
  void readAlpha(const nlohmann::json& from, float base_alpha, MeshMaterial& material) const;

  const GltfDocument& gltf_;
  MeshBuilder& builder_;
  std::uint32_t plain_ = 0;                        // the number after the last
  std::deque<std::vector<unsigned char>> images_;  // inside URIs; their places stay
};

}  // namespace foci
