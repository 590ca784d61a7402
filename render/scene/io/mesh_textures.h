// Finds and reads the textures that a mesh names. Private to the readers of meshes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "render/scene/mesh/texture.h"

struct aiScene;

namespace foci {

inline constexpr std::uint64_t kMaxTexturePixels = 1 << 26;

/// The file of a texture: as the mesh names it, from the mesh's folder. Exporters also write paths
/// of the machine that they ran on. So a file of that name counts that lies beside the mesh, or in
/// a folder "textures" there; case does not count in these two. Absent if there is none.
std::optional<std::filesystem::path> textureFile(const std::filesystem::path& mesh,
                                                 std::string name);

class MeshTextures {
 public:
  /// @param scene  may embed textures; has to outlive this
  MeshTextures(const std::filesystem::path& mesh, const aiScene& scene)
      : mesh_(mesh), scene_(scene) {}

  /// Null, with a remark, if it cannot be read or has more than kMaxTexturePixels.
  /// @throws InputError if the file is a pipe or a device
  std::shared_ptr<const MeshTexture> read(const std::string& name);

  /// A mask of opacity: white, with an alpha. This is the image's own alpha if it has one that
  /// varies, as exporters name the texture of the colour twice; else its grey value. As `read`.
  std::shared_ptr<const MeshTexture> readMask(const std::string& name);

  const std::vector<std::string>& remarks() const { return remarks_; }

 private:
  /// Empty, with a remark that ends with `instead`, as `read`.
  cv::Mat image(std::string name, const char* instead);

  std::filesystem::path mesh_;
  const aiScene& scene_;
  std::vector<std::string> remarks_;
  std::map<std::string, std::shared_ptr<const MeshTexture>> textures_, masks_;
};

}  // namespace foci
