#include "render/scene/io/mesh.h"

#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/file.h"
#include "base/input_error.h"
#include "base/text.h"
#include "render/scene/io/gltf_json.h"
#include "render/scene/io/material_reader.h"
#include "render/scene/io/mesh_companions.h"
#include "render/scene/io/mesh_facts.h"
#include "render/scene/io/mesh_formats.h"
#include "render/scene/io/mesh_import.h"
#include "render/scene/io/mesh_objects.h"
#include "render/scene/io/texture_placement.h"
#include "render/scene/point_cloud.h"

namespace foci {
namespace {

glm::vec3 vec3Of(const aiVector3D& v) { return {v.x, v.y, v.z}; }

/// Whether the alpha of all corners is 0.
bool isClear(const aiMesh& mesh) {
  const aiColor4D* const first = mesh.mColors[0];
  return std::all_of(first, first + mesh.mNumVertices,
                     [](const aiColor4D& c) { return !(c.a > 0.0f); });
}

/// Whether colours of corners have an alpha that matters. Assimp gives the alpha 0 to all corners
/// of a mesh whose colours have none.
bool hasAlpha(const aiMesh& mesh) {
  const aiColor4D* const first = mesh.mColors[0];
  return !isClear(mesh) && std::any_of(first, first + mesh.mNumVertices,
                                       [](const aiColor4D& c) { return c.a < 1.0f; });
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
      : path_(path),
        gltf_(isGltf(path)),
        import_(path),
        scene_(read(import_)),
        materials_(path, scene_) {}

  MeshFile file() {
    TriangleMesh mesh;
    SceneObjects objects = objectsOf(scene_);
    for (unsigned m = 0; m < scene_.mNumMeshes; ++m) {
      append(mesh, *scene_.mMeshes[m]);
      if (!objects.empty()) mesh.objects.of.resize(mesh.size(), objects.of[m]);
    }
    mesh.objects.names = std::move(objects.names);
    if (!mesh.color.empty()) mesh.color.resize(mesh.corners_m.size(), glm::vec3(-1.0f));
    if (!mesh.alpha.empty()) mesh.alpha.resize(mesh.corners_m.size(), 1.0f);
    if (!(areaOf_m2(mesh.corners_m) > 0.0)) {
      throw InputError(path_.string(),
                       "has no triangle with an area within 1e9 units of the origin");
    }
    const std::vector<bool> used = usedMaterials(scene_);
    for (unsigned i = 0; i < scene_.mNumMaterials; ++i) {
      mesh.materials.push_back(used[i] ? materials_.read(i) : MeshMaterial{});
    }
    mesh.remarks = materials_.remarks();
    for (std::string& remark : import_.remarks()) mesh.remarks.push_back(std::move(remark));
    remarkUndefined(mesh);
    if (unusable_ > 0) {
      mesh.remarks.push_back(
          thousands(static_cast<double>(unusable_)) +
          (unusable_ == 1 ? " triangle has" : " triangles have") +
          " a corner that is not finite, or farther than 1e9 units from the origin: left out");
    }
    SceneFacts facts = meshFacts(scene_, path_);
    finishTriangles(mesh, facts);
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

  /// OBJ: materials in use that no file of materials defines. A file that is missing is remarked
  /// already.
  void remarkUndefined(TriangleMesh& mesh) const {
    if (lowerExtension(path_) != ".obj") return;
    const std::vector<std::string> defined = definedMaterials(path_);
    if (defined.empty()) return;
    const std::set<std::uint32_t> used(mesh.material.begin(), mesh.material.end());
    for (const std::uint32_t m : used) {
      const std::string name = scene_.mMaterials[m]->GetName().C_Str();
      if (name == AI_DEFAULT_MATERIAL_NAME ||
          std::find(defined.begin(), defined.end(), name) != defined.end()) {
        continue;
      }
      mesh.remarks.push_back("material " + shown(name) +
                             " is in none of its MTL files: shown in grey");
    }
  }

  void append(TriangleMesh& all, const aiMesh& mesh) {
    const TexturePlacement placement = materials_.placementOf(mesh.mMaterialIndex);
    const bool has_uv = mesh.HasTextureCoords(placement.set), has_rgba = mesh.HasVertexColors(0);
    const bool has_color = has_rgba;
    const bool has_alpha = gltf_ && has_rgba && hasAlpha(mesh);
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
      if (!usable) {
        ++unusable_;
        continue;
      }
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
        if (has_uv) {
          const aiVector3D& at = mesh.mTextureCoords[placement.set][i];
          uv = placement.of({at.x, at.y});
        }
        const bool placed = std::abs(uv.x) < 1e6f && std::abs(uv.y) < 1e6f;
        all.uv.push_back(placed ? uv : glm::vec2(0.0f));
        if (!has_rgba) continue;
        const aiColor4D& c = mesh.mColors[0][i];
        if (has_alpha) {
          all.alpha.resize(all.corners_m.size() - 1, 1.0f);
          all.alpha.push_back(c.a >= 0.0f ? std::min(c.a, 1.0f) : 0.0f);
        }
        if (!has_color) continue;
        refuseBytes({c.r, c.g, c.b});
        all.color.resize(all.corners_m.size() - 1, glm::vec3(-1.0f));
        all.color.push_back(linearColor(c, !gltf_));
      }
      all.material.push_back(mesh.mMaterialIndex);
    }
  }

  /// Colours of 0 to 255 would all become white. Light of a glTF may be above 1.
  void refuseBytes(const glm::vec3& color) const {
    constexpr float kSlack = 1e-3f;
    const float brightest = std::max({color.x, color.y, color.z});
    if (gltf_ || !(brightest > 1.0f + kSlack)) return;
    throw InputError(path_.string(), "colour " + decimal(double{brightest}, 3) +
                                         " of a vertex: expected 0 to 1; divide colours of 0 to "
                                         "255 by 255");
  }

  std::filesystem::path path_;
  bool gltf_;
  MeshImport import_;
  const aiScene& scene_;  // of the import
  MaterialReader materials_;
  std::size_t unusable_ = 0;  // triangles
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
  return isPlyMesh(ply::readHeader(input));
}

MeshFile readMesh(const std::filesystem::path& path) {
  if (lowerExtension(path) == ".ply") return readPlyMesh(path);
  return Loader(path).file();
}

}  // namespace foci
