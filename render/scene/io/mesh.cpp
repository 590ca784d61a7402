#include "render/scene/io/mesh.h"

#include <assimp/GltfMaterial.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/file.h"
#include "base/input_error.h"
#include "base/text.h"
#include "render/image/srgb.h"
#include "render/scene/io/gltf_json.h"
#include "render/scene/io/mesh_companions.h"
#include "render/scene/io/mesh_facts.h"
#include "render/scene/io/mesh_import.h"
#include "render/scene/io/mesh_objects.h"
#include "render/scene/io/mesh_textures.h"
#include "render/scene/io/ply_header.h"
#include "render/scene/io/texture_placement.h"
#include "render/scene/point_cloud.h"

namespace foci {
namespace {

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
      : path_(path),
        gltf_(isGltf(path)),
        import_(path),
        scene_(read(import_)),
        textures_(path, scene_) {}

  MeshFile file() {
    TriangleMesh mesh;
    SceneObjects objects = objectsOf(scene_);
    for (unsigned m = 0; m < scene_.mNumMeshes; ++m) {
      append(mesh, *scene_.mMeshes[m]);
      if (!objects.empty()) mesh.objects.of.resize(mesh.size(), objects.of[m]);
    }
    mesh.objects.names = std::move(objects.names);
    if (!mesh.color.empty()) mesh.color.resize(mesh.corners_m.size(), glm::vec3(-1.0f));
    if (!(areaOf_m2(mesh.corners_m) > 0.0)) {
      throw InputError(path_.string(),
                       "has no triangle with an area within 1e9 units of the origin");
    }
    for (unsigned i = 0; i < scene_.mNumMaterials; ++i) {
      mesh.materials.push_back(materialOf(*scene_.mMaterials[i]));
    }
    mesh.remarks = textures_.remarks();
    if (glowing_) {
      mesh.remarks.emplace_back(
          "materials that are black but emit light have the colour of that light; they light "
          "nothing else");
    }
    if (masked_) {
      mesh.remarks.emplace_back(
          "materials with a mask of opacity (map_d) are shown without it; a texture with alpha "
          "cuts "
          "holes");
    }
    if (fading_) {
      mesh.remarks.emplace_back("the alpha of the corners' colours is left out");
    }
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
    const TexturePlacement placement = placementOf(mesh.mMaterialIndex);
    const bool has_uv = mesh.HasTextureCoords(placement.set), has_color = mesh.HasVertexColors(0);
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
        if (!has_color) continue;
        const aiColor4D& c = mesh.mColors[0][i];
        refuseBytes({c.r, c.g, c.b});
        const glm::vec3 color = unitColor({c.r, c.g, c.b});
        fading_ = fading_ || (gltf_ && c.a < 1.0f);
        all.color.resize(all.corners_m.size() - 1, glm::vec3(-1.0f));
        all.color.push_back(gltf_ ? color : linearOf(color));
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

  /// Whether a material is black but for the light that it emits.
  bool glows(const aiMaterial& material) const {
    aiColor4D color(1.0f);
    if (!(gltf_ && material.Get(AI_MATKEY_BASE_COLOR, color) == aiReturn_SUCCESS) &&
        material.Get(AI_MATKEY_COLOR_DIFFUSE, color) != aiReturn_SUCCESS) {
      return false;
    }
    aiColor4D light(0.0f);
    return color.r == 0.0f && color.g == 0.0f && color.b == 0.0f &&
           material.Get(AI_MATKEY_COLOR_EMISSIVE, light) == aiReturn_SUCCESS &&
           (light.r > 0.0f || light.g > 0.0f || light.b > 0.0f);
  }

  /// The texture of a material's colour.
  std::optional<aiTextureType> colorTexture(const aiMaterial& material) const {
    if (glows(material)) {
      if (material.GetTextureCount(aiTextureType_EMISSIVE) == 0) return std::nullopt;
      return aiTextureType_EMISSIVE;
    }
    for (const aiTextureType type : {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE}) {
      if (material.GetTextureCount(type) > 0) return type;
    }
    return std::nullopt;
  }

  TexturePlacement placementOf(unsigned material) const {
    if (material >= scene_.mNumMaterials) return {};
    const std::optional<aiTextureType> type = colorTexture(*scene_.mMaterials[material]);
    return type ? texturePlacement(*scene_.mMaterials[material], *type, gltf_) : TexturePlacement{};
  }

  /// Whether Assimp gave this material, which is white, to the triangles of a file without one.
  bool isUncoloured(const aiMaterial& material) const {
    const aiString name = material.GetName();
    return name == aiString(AI_DEFAULT_MATERIAL_NAME) ||
           (name.length == 0 && lowerExtension(path_) == ".ply");
  }

  MeshMaterial materialOf(const aiMaterial& from) {
    MeshMaterial material;
    const aiColor4D grey(0.6f, 0.6f, 0.6f, 1.0f);
    aiColor4D color = grey;
    const bool colored = (gltf_ && from.Get(AI_MATKEY_BASE_COLOR, color) == aiReturn_SUCCESS) ||
                         from.Get(AI_MATKEY_COLOR_DIFFUSE, color) == aiReturn_SUCCESS;
    if (isUncoloured(from)) color = grey;
    if (glows(from)) {
      from.Get(AI_MATKEY_COLOR_EMISSIVE, color);
      color.a = 1.0f;
      glowing_ = true;
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
    aiString name;
    const std::optional<aiTextureType> type = colorTexture(from);
    if (type && from.GetTexture(*type, 0, &name) == aiReturn_SUCCESS) {
      material.texture = textures_.read(name.C_Str());
      if ((!gltf_ || !colored) && material.texture) material.factor = glm::vec3(1.0f);
    }
    material.tinted =
        gltf_ && !glows(from) && (material.texture || (colored && !isUncoloured(from)));
    masked_ = masked_ || (!gltf_ && from.GetTextureCount(aiTextureType_OPACITY) > 0);
    return material;
  }

  std::filesystem::path path_;
  bool gltf_;
  MeshImport import_;
  const aiScene& scene_;  // of the import
  MeshTextures textures_;
  std::size_t unusable_ = 0;               // triangles
  bool glowing_ = false, masked_ = false;  // a material
  bool fading_ = false;                    // the colour of a corner
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
