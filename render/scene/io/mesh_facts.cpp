#include "render/scene/io/mesh_facts.h"

#include <assimp/GltfMaterial.h>
#include <assimp/material.h>
#include <assimp/scene.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>

#include "base/file.h"
#include "base/text.h"
#include "render/scene/io/gltf_json.h"
#include "render/scene/io/named_file.h"
#include "render/scene/io/scan_values.h"
#include "render/scene/mesh/orientation.h"

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
               name != aiString("BLEND"))) {
    facts.opacity = 1.0f;
  }
  for (const aiTextureType type : {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE}) {
    if (material.GetTexture(type, 0, &name) != aiReturn_SUCCESS) continue;
    const bool found = scene.GetEmbeddedTexture(name.C_Str()) != nullptr ||
                       namedFile(path, percentDecoded(name.C_Str())).has_value();
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

/// Where the colours of the triangles come from.
void takeColors(const TriangleMesh& mesh, SceneFacts& facts) {
  std::optional<glm::vec3> flat, vertex;
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    static const MeshMaterial plain;
    const std::uint32_t m = mesh.material[i];
    const MeshMaterial& material = m < mesh.materials.size() ? mesh.materials[m] : plain;
    if (material.texture) {
      facts.has_colors = true;
    } else if (!mesh.color.empty() && mesh.color[3 * i].x >= 0.0f) {
      for (std::size_t k = 0; k < 3 && !facts.has_colors; ++k) {
        const glm::vec3& color = mesh.color[3 * i + k];
        facts.has_colors = color != vertex.value_or(color);
        vertex = color;
      }
    } else {
      facts.material_colors =
          facts.material_colors || material.factor != flat.value_or(material.factor);
      flat = material.factor;
    }
    if (facts.has_colors) return;
  }
}

/// The least opacity that the corners' alpha makes.
void takeAlpha(const TriangleMesh& mesh, SceneFacts& facts) {
  for (std::size_t i = 0; i < mesh.alpha.size(); ++i) {
    const std::uint32_t m = mesh.material[i / 3];
    if (m >= mesh.materials.size() || mesh.materials[m].alpha != AlphaUse::blend) continue;
    facts.opacity.x = std::min(facts.opacity.x, mesh.alpha[i] * mesh.materials[m].opacity);
  }
}

}  // namespace

void refuseRepeats(const aiScene& scene) { Repeats().add(scene, *scene.mRootNode); }

void finishTriangles(TriangleMesh& mesh, SceneFacts& facts) {
  const std::size_t repeated = dropUseless(mesh);
  if (repeated > 0) {
    mesh.remarks.push_back(thousands(static_cast<double>(repeated)) +
                           (repeated == 1 ? " triangle repeats another one: it is left out"
                                          : " triangles repeat others: they are left out"));
  }
  orientOutwards(mesh);
  facts.triangles = mesh.size();
  takeAlpha(mesh, facts);
  takeColors(mesh, facts);
  if (losesDetail(mesh.corners_m)) {
    mesh.remarks.emplace_back(
        "the mesh is so far from the origin that its detail is lost: move it to the origin, e.g. "
        "with CloudCompare");
  }
}

std::vector<bool> usedMaterials(const aiScene& scene) {
  std::vector<bool> used(scene.mNumMaterials);
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    const unsigned material = scene.mMeshes[m]->mMaterialIndex;
    if (material < used.size()) used[material] = true;
  }
  return used;
}

SceneFacts meshFacts(const aiScene& scene, const std::filesystem::path& path) {
  SceneFacts facts{.kind = kindOfMesh(path)};
  if (facts.kind == SceneKind::gltf) facts.unit_m = 1.0;
  if (facts.kind == SceneKind::fbx && scene.mMetaData != nullptr) {
    takeMetadata(*scene.mMetaData, facts);
  }
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    facts.has_normals = facts.has_normals || scene.mMeshes[m]->HasNormals();
  }
  const std::vector<bool> used = usedMaterials(scene);
  for (unsigned m = 0; m < scene.mNumMaterials; ++m) {
    // Assimp gives this material to a mesh without one.
    if (scene.mMaterials[m]->GetName() == aiString(AI_DEFAULT_MATERIAL_NAME)) continue;
    if (!used[m]) continue;
    facts.materials.push_back(factsOf(*scene.mMaterials[m], scene, path));
    facts.opacity.x = std::min(facts.opacity.x, facts.materials.back().opacity);
  }
  return facts;
}

}  // namespace foci
