// What a mesh holds, as Assimp reads it.
#include <assimp/GltfMaterial.h>
#include <assimp/material.h>
#include <assimp/scene.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "base/file.h"
#include "base/input_error.h"
#include "render/scene/io/gltf_json.h"
#include "render/scene/io/mesh_import.h"
#include "render/scene/io/scene_facts.h"
#include "render/scene/point_cloud.h"

namespace foci {
namespace {

constexpr std::size_t kMaxCountedInstances = 1'000'000, kMaxCountedCorners = 300'000'000;

SceneKind kindOfMesh(const std::filesystem::path& path) {
  const std::string extension = lowerExtension(path);
  if (isGltf(path)) return SceneKind::gltf;
  if (extension == ".obj") return SceneKind::obj;
  if (extension == ".stl") return SceneKind::stl;
  return extension == ".fbx" ? SceneKind::fbx : SceneKind::ply_mesh;
}

/// Counts triangles and takes their corners, with the transforms of the nodes applied.
class MeshCounter {
 public:
  MeshCounter(const aiScene& scene, const std::filesystem::path& path, SceneFacts& facts)
      : scene_(scene), path_(path), facts_(facts) {}

  void add(const aiNode& node, const aiMatrix4x4& world_from_parent) {
    const aiMatrix4x4 world_from_node = world_from_parent * node.mTransformation;
    for (unsigned m = 0; m < node.mNumMeshes; ++m) {
      add(*scene_.mMeshes[node.mMeshes[m]], world_from_node);
    }
    for (unsigned c = 0; c < node.mNumChildren; ++c) add(*node.mChildren[c], world_from_node);
  }

 private:
  void add(const aiMesh& mesh, const aiMatrix4x4& world_from_mesh) {
    if (++instances_ > kMaxCountedInstances || facts_.position.size() > kMaxCountedCorners) {
      throw InputError(path_.string(), "repeats its parts more than a million times");
    }
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices < 3) continue;
      facts_.triangles += face.mNumIndices - 2;
    }
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
      const aiVector3D p = world_from_mesh * mesh.mVertices[v];
      const bool usable = std::abs(p.x) <= kFarthest_m && std::abs(p.y) <= kFarthest_m &&
                          std::abs(p.z) <= kFarthest_m;  // false for NaN
      if (usable) facts_.position.emplace_back(p.x, p.y, p.z);
    }
    facts_.has_normals = facts_.has_normals || mesh.HasNormals();
    facts_.has_colors = facts_.has_colors || mesh.HasVertexColors(0);
  }

  const aiScene& scene_;
  const std::filesystem::path& path_;
  SceneFacts& facts_;
  std::size_t instances_ = 0;
};

MaterialFacts factsOf(const aiMaterial& material, const aiScene& scene,
                      const std::filesystem::path& path) {
  MaterialFacts facts;
  aiString name;
  if (material.Get(AI_MATKEY_NAME, name) == aiReturn_SUCCESS) facts.name = name.C_Str();
  float opacity = 1.0f;
  if (material.Get(AI_MATKEY_OPACITY, opacity) == aiReturn_SUCCESS && opacity >= 0.0f) {
    facts.opacity = std::min(opacity, 1.0f);
  }
  const bool gltf = kindOfMesh(path) == SceneKind::gltf;
  if (gltf && (material.Get(AI_MATKEY_GLTF_ALPHAMODE, name) != aiReturn_SUCCESS ||
               std::string(name.C_Str()) == "OPAQUE")) {
    facts.opacity = 1.0f;
  }
  for (const aiTextureType type : {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE}) {
    if (material.GetTexture(type, 0, &name) != aiReturn_SUCCESS) continue;
    std::string file = name.C_Str();
    std::replace(file.begin(), file.end(), '\\', '/');
    std::error_code ignored;
    const bool found = scene.GetEmbeddedTexture(name.C_Str()) != nullptr ||
                       std::filesystem::is_regular_file(path.parent_path() / file, ignored);
    facts.textures.push_back({name.C_Str(), found});
    break;
  }
  return facts;
}

/// FBX files state centimetres a unit, and their upward axis.
void takeMetadata(const aiMetadata& metadata, SceneFacts& facts) {
  double unit_cm = 0.0;
  float unit_cm_float = 0.0f;
  if (metadata.Get("UnitScaleFactor", unit_cm) || (metadata.Get("UnitScaleFactor", unit_cm_float) &&
                                                   ((unit_cm = double{unit_cm_float}), true))) {
    if (unit_cm > 1e-6 && unit_cm < 1e6) facts.unit_m = 0.01 * unit_cm;
  }
  int axis = 0;
  if (metadata.Get("UpAxis", axis) && axis >= 0 && axis <= 2) facts.up_axis = axis;
}

}  // namespace

SceneFacts readMeshFacts(const std::filesystem::path& path) {
  MeshImport import(path);
  const aiScene& scene =
      import.read([](Assimp::Importer& importer) { return importer.GetScene(); });
  SceneFacts facts{.kind = kindOfMesh(path)};
  if (facts.kind == SceneKind::gltf) facts.unit_m = 1.0;
  if (facts.kind == SceneKind::fbx && scene.mMetaData != nullptr) {
    takeMetadata(*scene.mMetaData, facts);
  }
  MeshCounter(scene, path, facts).add(*scene.mRootNode, aiMatrix4x4());
  if (facts.position.empty() || facts.triangles == 0) {
    throw InputError(path.string(), "has no triangle with an area");
  }
  for (unsigned m = 0; m < scene.mNumMaterials; ++m) {
    // Assimp gives this material to a mesh without one.
    if (scene.mMaterials[m]->GetName() == aiString(AI_DEFAULT_MATERIAL_NAME)) continue;
    facts.materials.push_back(factsOf(*scene.mMaterials[m], scene, path));
    const MaterialFacts& material = facts.materials.back();
    facts.opacity.x = std::min(facts.opacity.x, material.opacity);
    facts.has_colors = facts.has_colors || !material.textures.empty();
  }
  facts.remarks = import.missing();
  return facts;
}

}  // namespace foci
