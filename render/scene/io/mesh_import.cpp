#include "render/scene/io/mesh_import.h"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include "base/input_error.h"
#include "render/scene/io/mesh_limits.h"

namespace foci {

MeshImport::MeshImport(const std::filesystem::path& path) : path_(path) {
  importer_.SetIOHandler(files_);
  refuseHostileMesh(path);
  compression_ = compressionOf(path);
  if (!mayBeRead(compression_)) throw InputError(path.string(), compressionRefusal(compression_));
  importer_.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE,
                               aiPrimitiveType_POINT | aiPrimitiveType_LINE);
}

bool MeshImport::readFile() {
  return importer_.ReadFile(path_.string(), aiProcess_ValidateDataStructure) != nullptr;
}

void MeshImport::refuse(std::string why) const {
  for (char& c : why) {
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';
  }
  throw InputError(path_.string(), "is no mesh that can be read: " + why.substr(0, 200) +
                                       compressionRemark(compression_));
}

std::vector<std::string> MeshImport::missing() const {
  std::vector<std::string> remarks;
  for (const std::string& name : files_->missing()) {
    remarks.push_back("the file " + name + " cannot be read: its materials are shown in grey");
  }
  return remarks;
}

}  // namespace foci
