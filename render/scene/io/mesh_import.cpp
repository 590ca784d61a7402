#include "render/scene/io/mesh_import.h"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <fstream>
#include <optional>
#include <utility>

#include "base/file.h"
#include "base/input_error.h"
#include "base/text.h"
#include "render/scene/io/gltf_json.h"
#include "render/scene/io/gltf_ranges.h"
#include "render/scene/io/gltf_unshown.h"

namespace foci {
namespace {

/// Whether the file starts with the byte order mark of UTF-16, which Assimp takes for text.
bool isUtf16(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  const int first = in.get(), second = in.get();
  return (first == 0xfe && second == 0xff) || (first == 0xff && second == 0xfe);
}

/// Errors of Assimp about what is inside of it, in our words.
std::string inWords(const std::string& why) {
  const auto says = [&](const char* text) { return why.find(text) != std::string::npos; };
  if (says("scene-graph is nullptr")) return "it has no scene with nodes";
  if (says("mIndices") && says("out of range")) return "a face names a vertex that is not there";
  if (says("mNumMeshes is 0")) return "it has no faces";
  if (says("Cannot parse string")) return "it has another text where a number was expected";
  if (says("Invalid number of vertices") || says("Normal buffer size does not match")) {
    return "a triangle is incomplete, so the file may be cut off";
  }
  if (says("Validation failed")) return "its parts contradict each other";
  return why;
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
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) {
    throw InputError(path.string(), "cannot be read");
  }
  std::optional<GltfDocument> gltf;
  if (isGltf(path)) {
    gltf = readGltf(path);
    stated_ = refuseHostileGltf(*gltf);
    compression_ = compressionOf(*gltf);
    if (!mayBeRead(compression_)) throw InputError(path.string(), compressionRefusal(compression_));
    refuseUnknownExtensions(*gltf);
    refuseOverreachingGltf(*gltf);
    remarks_ = gltfUnshown(*gltf);
  } else if (isUtf16(path)) {
    throw InputError(path.string(), "is text in UTF-16: save it in UTF-8");
  }
  files_->mend(path, std::move(gltf));
  importer_.SetPropertyBool(AI_CONFIG_PP_PTV_KEEP_HIERARCHY, true);  // nodes are objects
  importer_.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE,
                               aiPrimitiveType_POINT | aiPrimitiveType_LINE);
}

bool MeshImport::readFile() {
  if (importer_.ReadFile(path_.string(), aiProcess_ValidateDataStructure) == nullptr) return false;
  const aiScene& scene = *importer_.GetScene();
  std::uint64_t faces = 0;
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) faces += scene.mMeshes[m]->mNumFaces;
  if (stated_ && stated_->parts == scene.mNumMeshes && faces < stated_->triangles) {
    const std::uint64_t lost = stated_->triangles - faces;
    remarks_.push_back(thousands(static_cast<double>(lost)) +
                       (lost == 1 ? " triangle names a vertex that is not there: it is left out"
                                  : " triangles name vertices that are not there: left out"));
  }
  return true;
}

void MeshImport::refuse(std::string why) const {
  for (char& c : why) {
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';
  }
  while (why.ends_with('.') || why.ends_with(' ')) why.pop_back();
  throw InputError(path_.string(), "is no mesh that can be read: " + inWords(why).substr(0, 200) +
                                       compressionRemark(compression_) + adviceFor(why));
}

std::vector<std::string> MeshImport::remarks() const {
  std::vector<std::string> remarks = remarks_;
  remarks.insert(remarks.end(), files_->remarks().begin(), files_->remarks().end());
  for (const std::string& name : files_->missing()) {
    remarks.push_back("the file " + name + " cannot be read: its materials are shown in grey");
  }
  return remarks;
}

}  // namespace foci
