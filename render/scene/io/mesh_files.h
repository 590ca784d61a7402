// The files that Assimp opens for a mesh: which are missing, and how a glTF is compressed. Private
// to the readers of meshes.
#pragma once

#include <assimp/DefaultIOSystem.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "render/scene/io/gltf_document.h"
#include "render/scene/io/mended_file.h"

namespace foci {

/// Opens files for Assimp, and keeps the names of those that cannot be read.
class MeshFiles : public Assimp::DefaultIOSystem {
 public:
  /// Gives Assimp, which opens the mesh next, the rewritten content if Assimp would misread the
  /// file.
  /// @param gltf  the JSON of the mesh, if it is a glTF
  /// @throws InputError if the file is damaged
  void mend(const std::filesystem::path& mesh, std::optional<GltfDocument> gltf);

  bool Exists(const char* name) const override;
  /// @throws InputError for a pipe or a device: opening it could take for ever
  Assimp::IOStream* Open(const char* name, const char* mode) override;

  /// Names without their folder, printable, in the order in which Assimp asked for them. For a file
  /// of materials that is missing, Assimp tries a second name: this name does not count.
  std::vector<std::string> missing() const;

  /// What the user should know of the mesh that was opened.
  const std::vector<std::string>& remarks() const { return mended_.remarks; }

 private:
  /// The file that a name means: of a glTF, whose names are URIs, decoded if no file has the name.
  std::string fileOf(const char* name) const;

  std::filesystem::path mesh_;  // opened first
  MendedFile mended_;           // its content, if Assimp would misread it; outlives streams
  std::vector<std::string> missing_;
};

/// The compression that a glTF requires, e.g. "EXT_meshopt_compression"; "" if it requires none.
std::string compressionOf(const GltfDocument& gltf);

/// @throws InputError for a glTF that requires an extension which foci does not read, and which
///         would change the image
void refuseUnknownExtensions(const GltfDocument& gltf);

/// Assimp reads no meshopt compression, and Draco's only where it was built with it.
bool mayBeRead(const std::string& compression);

/// Why such a file is refused, and what to do.
std::string compressionRefusal(const std::string& compression);

/// What to add to the reason why a file cannot be read: its compression, if it has one.
std::string compressionRemark(const std::string& compression);

}  // namespace foci
