#include "render/scene/io/mesh_facts.h"

#include <assimp/GltfMaterial.h>
#include <assimp/material.h>
#include <assimp/scene.h>

#include <algorithm>
#include <stdexcept>
#include <string>

#include "base/file.h"
#include "render/scene/io/gltf_json.h"

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

/// Meshes and their corners below a node, with repeats.
struct Repeats {
  std::size_t instances = 0, corners = 0;

  void add(const aiScene& scene, const aiNode& node) {
    for (unsigned m = 0; m < node.mNumMeshes; ++m) {
      corners += scene.mMeshes[node.mMeshes[m]]->mNumVertices;
      if (++instances > kMaxCountedInstances || corners > kMaxCountedCorners) {
        throw std::runtime_error("it repeats its parts more than a million times");
      }
    }
    for (unsigned c = 0; c < node.mNumChildren; ++c) add(scene, *node.mChildren[c]);
  }
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

void refuseRepeats(const aiScene& scene) { Repeats().add(scene, *scene.mRootNode); }

SceneFacts meshFacts(const aiScene& scene, const std::filesystem::path& path) {
  SceneFacts facts{.kind = kindOfMesh(path)};
  if (facts.kind == SceneKind::gltf) facts.unit_m = 1.0;
  if (facts.kind == SceneKind::fbx && scene.mMetaData != nullptr) {
    takeMetadata(*scene.mMetaData, facts);
  }
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    facts.has_normals = facts.has_normals || scene.mMeshes[m]->HasNormals();
    facts.has_colors = facts.has_colors || scene.mMeshes[m]->HasVertexColors(0);
  }
  for (unsigned m = 0; m < scene.mNumMaterials; ++m) {
    // Assimp gives this material to a mesh without one.
    if (scene.mMaterials[m]->GetName() == aiString(AI_DEFAULT_MATERIAL_NAME)) continue;
    facts.materials.push_back(factsOf(*scene.mMaterials[m], scene, path));
    const MaterialFacts& material = facts.materials.back();
    facts.opacity.x = std::min(facts.opacity.x, material.opacity);
    facts.has_colors = facts.has_colors || !material.textures.empty();
  }
  return facts;
}

}  // namespace foci
