// Reads the textures that a mesh names. Private to the readers of meshes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/image_codec.h"
#include "base/memory_budget.h"
#include "render/scene/io/scene_facts.h"
#include "render/scene/mesh/texture.h"

namespace foci {

struct ImageSource {
  std::string name;                             ///< as the mesh names it
  std::optional<std::filesystem::path> file{};  ///< absent: there is none
  std::span<const unsigned char> bytes{};       ///< of an image inside the mesh; has to stay

  bool exists() const { return file || !bytes.empty(); }
};

class MeshTextures {
 public:
  /// @param mesh  for messages and the budget of memory
  explicit MeshTextures(const std::filesystem::path& mesh) : budget_(mesh) {}

  /// Null, with a remark, if it cannot be read or has more than kMaxImagePixels.
  /// @param as_mask  of opacity: white, with an alpha. This is the image's own alpha if it has one
  ///                 that varies, as exporters name the texture of the colour twice; else its grey
  /// @throws InputError if the file is a pipe or a device, or if all textures take too much memory
  std::shared_ptr<const MeshTexture> read(const ImageSource& source, bool as_mask = false);

  const std::vector<std::string>& remarks() const { return remarks_; }

 private:
  /// Nothing, with a remark that ends with `instead`.
  std::optional<DecodedImage> image(const ImageSource& source, const char* instead);
  std::optional<DecodedImage> decoded(std::span<const unsigned char> bytes);

  MemoryBudget budget_;
  std::vector<std::string> remarks_;
  std::map<std::pair<std::string, bool>, std::shared_ptr<const MeshTexture>> textures_;
};

/// What `foci info` says of a texture.
inline TextureFacts factsOf(const ImageSource& source) { return {source.name, source.exists()}; }

}  // namespace foci
