// The materials of a mesh as Assimp reads them: colours, textures, alpha. Private to the readers of
// meshes.
#pragma once

#include <assimp/material.h>

#include <filesystem>
#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "render/scene/io/mesh_companions.h"
#include "render/scene/io/mesh_textures.h"
#include "render/scene/io/texture_placement.h"
#include "render/scene/mesh/triangle_mesh.h"

struct aiScene;

namespace foci {

/// Linear RGB, 0 to 1; NaN becomes 0.
glm::vec3 linearColor(const aiColor4D& color, bool srgb);

class MaterialReader {
 public:
  /// @param scene  read from `mesh`; has to outlive this
  MaterialReader(const std::filesystem::path& mesh, const aiScene& scene);

  /// How a material places its texture.
  TexturePlacement placementOf(unsigned material) const;

  MeshMaterial read(unsigned material);

  /// A sentence for each kind of thing in the materials read that is not shown as it is stated.
  std::vector<std::string> remarks() const;

 private:
  ImageSource imageSource(const std::string& name) const;
  bool glows(const aiMaterial& material) const;
  bool isUncoloured(const aiMaterial& material) const;
  std::optional<aiTextureType> colorTexture(const aiMaterial& material) const;
  void readAlpha(const aiMaterial& from, float base_alpha, MeshMaterial& material);

  std::filesystem::path path_;
  const aiScene& scene_;
  bool gltf_, obj_;
  MeshTextures textures_;
  std::map<std::string, MtlTexture> placed_;  // of an OBJ: Assimp may lose their names
  bool glowing_ = false, dimmed_ = false, masked_ = false;  // a material
};

}  // namespace foci
