// The files that a mesh names, materials, textures and buffers: finds them, and reads the textures.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/image_codec.h"
#include "base/memory_budget.h"
#include "render/scene/io/scene_facts.h"
#include "render/scene/mesh/triangle_mesh.h"

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
  ///                 that varies; else its grey
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

/// The file that a name means. Blanks around the name and a pair of double quotes do not count, and
/// a backslash separates folders. A file of this very name comes first, seen from the folder of
/// `beside`; then one whose name and folders differ in case alone. Exporters also write paths of
/// the machine that they ran on. So a file of that name counts that lies beside, or in a folder
/// "textures" there. Absent if there is none.
/// @param beside  the file that has the name
std::optional<std::filesystem::path> namedFile(const std::filesystem::path& beside,
                                               std::string_view name);

/// The name without blanks and quotes around it, for messages.
std::string_view plainName(std::string_view name);

/// A URI as the name of a file: "%20" becomes a blank (RFC 3986).
std::string percentDecoded(std::string_view uri);

/// The file that a URI means, as it stands, or else decoded.
std::optional<std::filesystem::path> fileOfUri(const std::filesystem::path& beside,
                                               const std::string& uri);

/// The files that a mesh names and that are there, each once: the material files of an OBJ and
/// their textures, the buffers and images of a glTF, the textures of a PLY. Never fails: what
/// cannot be read names none.
std::vector<std::filesystem::path> meshCompanions(const std::filesystem::path& mesh);

}  // namespace foci
