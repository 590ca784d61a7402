#include "render/scene/io/mesh.h"

#include <assimp/GltfMaterial.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/file.h"
#include "base/input_error.h"
#include "base/quiet_stderr.h"
#include "base/text.h"
#include "render/image/srgb.h"
#include "render/scene/io/gltf_json.h"
#include "render/scene/io/mesh_facts.h"
#include "render/scene/io/mesh_import.h"
#include "render/scene/io/ply_header.h"
#include "render/scene/mesh/texture.h"
#include "render/scene/point_cloud.h"

namespace foci {
namespace {

constexpr int kMaxTexturePixels = 1 << 26;

glm::vec3 vec3Of(const aiVector3D& v) { return {v.x, v.y, v.z}; }

/// Clamps to 0 to 1; NaN becomes 0.
glm::vec3 unitColor(const glm::vec3& c) {
  const auto unit = [](float x) { return x >= 0.0f ? std::min(x, 1.0f) : 0.0f; };
  return {unit(c.x), unit(c.y), unit(c.z)};
}

glm::vec3 linearOf(const glm::vec3& srgb) {
  return {linearFromSrgb(srgb.x), linearFromSrgb(srgb.y), linearFromSrgb(srgb.z)};
}

/// Removes faces without corners. Assimp marks their mesh as one with polygons, and its
/// triangulation then asserts that there are polygons.
void dropEmptyFaces(aiMesh& mesh) {
  aiFace* const end = mesh.mFaces + mesh.mNumFaces;
  aiFace* const kept =
      std::remove_if(mesh.mFaces, end, [](const aiFace& face) { return face.mNumIndices == 0; });
  if (kept == end) return;
  mesh.mNumFaces = static_cast<unsigned>(kept - mesh.mFaces);
  const bool polygons =
      std::any_of(mesh.mFaces, kept, [](const aiFace& face) { return face.mNumIndices > 3; });
  if (!polygons) mesh.mPrimitiveTypes &= ~static_cast<unsigned>(aiPrimitiveType_POLYGON);
  if (mesh.mNumFaces == 0) mesh.mPrimitiveTypes = aiPrimitiveType_POINT;  // points are not imported
}

class Loader {
 public:
  explicit Loader(const std::filesystem::path& path)
      : path_(path), gltf_(isGltf(path)), import_(path), scene_(read(import_)) {}

  MeshFile file() {
    TriangleMesh mesh;
    for (unsigned m = 0; m < scene_.mNumMeshes; ++m) append(mesh, *scene_.mMeshes[m]);
    if (!mesh.color.empty()) mesh.color.resize(mesh.corners_m.size(), glm::vec3(-1.0f));
    if (!(areaOf_m2(mesh.corners_m) > 0.0)) {
      throw InputError(path_.string(), "has no triangle with an area");
    }
    for (unsigned i = 0; i < scene_.mNumMaterials; ++i) {
      mesh.materials.push_back(materialOf(*scene_.mMaterials[i]));
    }
    mesh.remarks = remarks_;
    for (std::string& remark : import_.missing()) mesh.remarks.push_back(std::move(remark));
    SceneFacts facts = meshFacts(scene_, path_);
    facts.triangles = mesh.size();
    return {std::move(mesh), std::move(facts)};
  }

 private:
  static const aiScene& read(MeshImport& import) {
    return import.read([](Assimp::Importer& importer) {
      const aiScene& read = *importer.GetScene();
      refuseRepeats(read);
      for (unsigned m = 0; m < read.mNumMeshes; ++m) dropEmptyFaces(*read.mMeshes[m]);
      return importer.ApplyPostProcessing(aiProcess_Triangulate | aiProcess_SortByPType |
                                          aiProcess_PreTransformVertices);
    });
  }

  void append(TriangleMesh& all, const aiMesh& mesh) const {
    const bool has_uv = mesh.HasTextureCoords(0), has_color = mesh.HasVertexColors(0);
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices != 3) continue;
      std::array<unsigned, 3> index{face.mIndices[0], face.mIndices[1], face.mIndices[2]};
      const bool usable = std::all_of(index.begin(), index.end(), [&](unsigned i) {
        if (i >= mesh.mNumVertices) return false;
        const aiVector3D& p = mesh.mVertices[i];
        return std::abs(p.x) <= kFarthest_m && std::abs(p.y) <= kFarthest_m &&
               std::abs(p.z) <= kFarthest_m;  // false for NaN
      });
      if (!usable) continue;
      if (mesh.HasNormals()) {
        const glm::vec3 a = vec3Of(mesh.mVertices[index[0]]), b = vec3Of(mesh.mVertices[index[1]]),
                        c = vec3Of(mesh.mVertices[index[2]]);
        glm::vec3 outwards(0.0f);
        for (const unsigned i : index) outwards += vec3Of(mesh.mNormals[i]);
        if (glm::dot(glm::cross(b - a, c - a), outwards) < 0.0f) std::swap(index[1], index[2]);
      }
      for (const unsigned i : index) {
        all.corners_m.push_back(vec3Of(mesh.mVertices[i]));
        glm::vec2 uv(0.0f);
        if (has_uv) uv = {mesh.mTextureCoords[0][i].x, mesh.mTextureCoords[0][i].y};
        const bool placed = std::abs(uv.x) < 1e6f && std::abs(uv.y) < 1e6f;
        all.uv.push_back(placed ? uv : glm::vec2(0.0f));
        if (!has_color) continue;
        const aiColor4D& c = mesh.mColors[0][i];
        const glm::vec3 color = unitColor({c.r, c.g, c.b});
        all.color.resize(all.corners_m.size() - 1, glm::vec3(-1.0f));
        all.color.push_back(gltf_ ? color : linearOf(color));
      }
      all.material.push_back(mesh.mMaterialIndex);
    }
  }

  MeshMaterial materialOf(const aiMaterial& from) {
    MeshMaterial material;
    aiColor4D color(0.6f, 0.6f, 0.6f, 1.0f);
    if (!gltf_ || from.Get(AI_MATKEY_BASE_COLOR, color) != aiReturn_SUCCESS) {
      from.Get(AI_MATKEY_COLOR_DIFFUSE, color);
    }
    material.factor = unitColor({color.r, color.g, color.b});
    if (!gltf_) material.factor = linearOf(material.factor);
    float opacity = gltf_ ? color.a : 1.0f;
    if (!gltf_) from.Get(AI_MATKEY_OPACITY, opacity);
    aiString mode;
    const bool opaque = gltf_ && (from.Get(AI_MATKEY_GLTF_ALPHAMODE, mode) != aiReturn_SUCCESS ||
                                  std::string(mode.C_Str()) == "OPAQUE");
    material.opacity = opaque || !(opacity >= 0.0f) ? 1.0f : std::min(opacity, 1.0f);
    material.cut_out = !opaque;
    for (const aiTextureType type : {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE}) {
      aiString name;
      if (from.GetTexture(type, 0, &name) != aiReturn_SUCCESS) continue;
      material.texture = textureOf(name.C_Str());
      if (!gltf_ && material.texture) material.factor = glm::vec3(1.0f);
      break;
    }
    return material;
  }

  /// Null if it cannot be read.
  std::shared_ptr<const MeshTexture> textureOf(const std::string& name) {
    const auto [at, is_new] = textures_.try_emplace(name);
    std::shared_ptr<const MeshTexture>& texture = at->second;
    if (!is_new) return texture;
    cv::Mat image;
    try {
      const QuietStderr quiet;
      image = imageOf(name);
    } catch (const cv::Exception&) {
      image.release();
    }
    const bool usable = !image.empty() && image.total() <= kMaxTexturePixels &&
                        (image.depth() == CV_8U || image.depth() == CV_16U) &&
                        image.channels() != 2;
    if (!usable) {
      remarks_.push_back("texture " + shown(name) +
                         " cannot be read: the colour of its material is shown");
      return texture;
    }
    texture = std::make_shared<const MeshTexture>(image);
    return texture;
  }

  cv::Mat imageOf(std::string name) const {
    if (const aiTexture* embedded = scene_.GetEmbeddedTexture(name.c_str())) {
      const int width = static_cast<int>(embedded->mWidth);
      if (embedded->mHeight == 0) {  // the bytes of an image file
        return cv::imdecode(cv::Mat(1, width, CV_8U, embedded->pcData), cv::IMREAD_UNCHANGED);
      }
      return cv::Mat(static_cast<int>(embedded->mHeight), width, CV_8UC4, embedded->pcData);
    }
    std::replace(name.begin(), name.end(), '\\', '/');
    const std::filesystem::path file = path_.parent_path() / name;
    if (!import_.files().Exists(file.c_str())) return {};
    requireRegularFile(file);
    return cv::imread(file.string(), cv::IMREAD_UNCHANGED);
  }

  std::filesystem::path path_;
  bool gltf_;
  MeshImport import_;
  const aiScene& scene_;  // of the import
  std::vector<std::string> remarks_;
  std::map<std::string, std::shared_ptr<const MeshTexture>> textures_;
};

}  // namespace

bool isMeshFile(const std::filesystem::path& path) {
  const std::string extension = lowerExtension(path);
  if (extension == ".obj" || extension == ".gltf" || extension == ".glb" || extension == ".stl" ||
      extension == ".fbx") {
    return true;
  }
  if (extension != ".ply") return false;
  ply::Input input(path);
  const ply::Header header = ply::readHeader(input);
  return std::any_of(header.elements.begin(), header.elements.end(), [](const auto& element) {
    return element.name == "face" && element.count > 0;
  });
}

MeshFile readMesh(const std::filesystem::path& path) { return Loader(path).file(); }

}  // namespace foci
