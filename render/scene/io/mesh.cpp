#include "render/scene/io/mesh.h"

#include <array>
#include <string>
#include <string_view>
#include <utility>

#include "base/file.h"
#include "base/input_error.h"
#include "render/scene/io/mesh_formats.h"

namespace foci {
namespace {

using Reader = MeshFile (*)(const std::filesystem::path&);

MeshFile readGltf(const std::filesystem::path& path) { return readGltfMesh(GltfDocument(path)); }

Reader readerOf(const std::filesystem::path& path) {
  constexpr std::array<std::pair<std::string_view, Reader>, 5> kReaders = {{{".obj", readObjMesh},
                                                                            {".gltf", readGltf},
                                                                            {".glb", readGltf},
                                                                            {".stl", readStlMesh},
                                                                            {".fbx", readFbxMesh}}};
  for (const auto& [extension, reader] : kReaders) {
    if (lowerExtension(path) == extension) return reader;
  }
  return readPlyMesh;
}

}  // namespace

bool isMeshFile(const std::filesystem::path& path) {
  if (readerOf(path) != readPlyMesh) return true;
  if (lowerExtension(path) != ".ply") return false;
  ply::Input input(path);
  return isPlyMesh(ply::readHeader(input));
}

MeshFile readMesh(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) {
    throw InputError(path.string(), "cannot be read");
  }
  return readerOf(path)(path);
}

}  // namespace foci
