#include "render/scene/io/mesh_import.h"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <fstream>

#include "base/input_error.h"
#include "render/scene/io/gltf_json.h"
#include "render/scene/io/mesh_limits.h"

namespace foci {
namespace {

/// Whether the file starts with the byte order mark of UTF-16, which Assimp takes for text.
bool isUtf16(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  const int first = in.get(), second = in.get();
  return (first == 0xfe && second == 0xff) || (first == 0xff && second == 0xfe);
}

/// What to do about an error of Assimp.
std::string adviceFor(const std::string& why) {
  const auto says = [&](const char* text) { return why.find(text) != std::string::npos; };
  if (says("could not open referenced file")) return ": put that file beside the mesh";
  if (says("mNumMeshes is 0") || says("No meshes remaining") || says("no faces") ||
      says("no vertices")) {
    return ": it has no faces, or an empty part; save points as PLY or XYZ";
  }
  return ": open it in Blender, for example, and export it again";
}

}  // namespace

MeshImport::MeshImport(const std::filesystem::path& path) : path_(path) {
  importer_.SetIOHandler(files_);
  refuseHostileMesh(path);
  compression_ = compressionOf(path);
  if (!mayBeRead(compression_)) throw InputError(path.string(), compressionRefusal(compression_));
  if (!isGltf(path_) && isUtf16(path_)) {
    throw InputError(path_.string(), "is text in UTF-16: save it in UTF-8");
  }
  importer_.SetPropertyBool(AI_CONFIG_PP_PTV_KEEP_HIERARCHY, true);  // nodes are objects
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
  while (why.ends_with('.') || why.ends_with(' ')) why.pop_back();
  throw InputError(path_.string(), "is no mesh that can be read: " + why.substr(0, 200) +
                                       compressionRemark(compression_) + adviceFor(why));
}

std::vector<std::string> MeshImport::missing() const {
  std::vector<std::string> remarks;
  for (const std::string& name : files_->missing()) {
    remarks.push_back("the file " + name + " cannot be read: its materials are shown in grey");
  }
  return remarks;
}

}  // namespace foci
