// Opens a mesh with Assimp. All checks of the file before it is read, and the reports of what was
// wrong with it, are here. Private to the readers of meshes.
#pragma once

#include <assimp/Importer.hpp>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "render/scene/io/mesh_files.h"
#include "render/scene/io/mesh_limits.h"

struct aiScene;

namespace foci {

class MeshImport {
 public:
  /// Refuses hostile files and compressions that cannot be read. Nothing is read yet.
  /// @throws InputError
  explicit MeshImport(const std::filesystem::path& path);

  const std::filesystem::path& path() const { return path_; }
  const MeshFiles& files() const { return *files_; }

  /// Reads the file, then calls `finish` with the importer: it may process the scene, which it
  /// returns.
  /// @throws InputError if Assimp cannot read the file
  template <class Finish>
  const aiScene& read(const Finish& finish) {
    const aiScene* scene = nullptr;
    try {
      if (readFile()) scene = finish(importer_);
    } catch (const std::exception& error) {
      refuse(error.what());
    }
    if (scene == nullptr) refuse(importer_.GetErrorString());
    return *scene;
  }

  /// A sentence for each file that was asked for and is missing, and for what was left out.
  std::vector<std::string> remarks() const;

 private:
  bool readFile();
  [[noreturn]] void refuse(std::string why) const;

  std::filesystem::path path_;
  std::string compression_;
  std::optional<StatedTriangles> stated_;
  std::vector<std::string> remarks_;
  Assimp::Importer importer_;
  MeshFiles* files_ = new MeshFiles;  // belongs to the importer
};

}  // namespace foci
