// FBX, through Assimp. Skins have the shape of their bones' nodes.
#include "render/scene/io/mesh_formats.h"

#ifdef FOCI_FBX

#include <assimp/commonMetaData.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <cmath>
#include <glm/glm.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/input_error.h"
#include "base/text.h"
#include "render/scene/io/mesh_builder.h"
#include "render/scene/io/mesh_files.h"

namespace foci {
namespace {

// Assimp follows the nodes without limits.
constexpr std::size_t kMaxFbxParts = 1'000'000, kMaxFbxCorners = 300'000'000;

glm::mat4 matrixOf(const aiMatrix4x4& matrix) { return glm::transpose(glm::make_mat4(&matrix.a1)); }

class FbxMesh {
 public:
  explicit FbxMesh(const std::filesystem::path& path)
      : path_(path), scene_(import()), builder_(path) {}

  MeshFile read() {
    addNode(*scene_.mRootNode, glm::mat4(1.0f), "");
    SceneFacts facts{.kind = SceneKind::fbx};
    if (scene_.mMetaData != nullptr) takeMetadata(*scene_.mMetaData, facts);
    MeshFile file =
        builder_.finish(std::move(facts), [&](std::uint32_t number) { return materialOf(number); });
    if (has_morphs_) file.mesh.remarks.emplace_back("its morph targets (shape keys) are left out");
    if (masked_) {
      file.mesh.remarks.emplace_back(
          "materials with a mask of opacity are shown without it; a texture with alpha cuts holes");
    }
    return file;
  }

 private:
  const aiScene& import() {
    const aiScene* scene = nullptr;
    std::string why;
    try {
      importer_.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE,
                                   aiPrimitiveType_POINT | aiPrimitiveType_LINE);
      scene = importer_.ReadFile(path_.string(), aiProcess_ValidateDataStructure |
                                                     aiProcess_Triangulate | aiProcess_SortByPType);
      why = importer_.GetErrorString();
    } catch (const std::exception& error) {
      why = error.what();
    }
    if (scene != nullptr && scene->mRootNode != nullptr) return *scene;
    for (char& c : why) {
      if (static_cast<unsigned char>(c) < ' ') c = ' ';
    }
    throw InputError(path_.string(), "is no FBX that can be read: ", why.substr(0, 200),
                     ": open it in Blender, for example, and export it again");
  }

  void addNode(const aiNode& node, const glm::mat4& scene_from_parent, const std::string& above) {
    glm::mat4 parent_from_node(1.0f);
    // The root of an FBX lies in the scene as it is; Assimp 5.4 turns it by the axes that the file
    // states.
    if (&node != scene_.mRootNode) {
      parent_from_node = matrixOf(node.mTransformation);
    }
    const glm::mat4 scene_from_node = scene_from_parent * parent_from_node;
    const std::string own = node.mName.C_Str(), &name = own.empty() ? above : own;
    if (node.mNumMeshes > 0) builder_.useObject(builder_.addObject(name));
    for (unsigned m = 0; m < node.mNumMeshes; ++m) {
      addMesh(*scene_.mMeshes[node.mMeshes[m]], scene_from_node);
    }
    for (unsigned c = 0; c < node.mNumChildren; ++c) {
      addNode(*node.mChildren[c], scene_from_node, name);
    }
  }

  void addMesh(const aiMesh& mesh, const glm::mat4& scene_from_mesh) {
    corners_ += mesh.mNumVertices;
    if (++parts_ > kMaxFbxParts || corners_ > kMaxFbxCorners) {
      throw InputError(path_.string(), "repeats its parts more than a million times");
    }
    const glm::mat3 turn(scene_from_mesh), of_normals(normalsFrom(turn));
    const std::vector<glm::mat4> skin = skinOf(mesh, scene_from_mesh);
    has_morphs_ |= mesh.mNumAnimMeshes > 0;
    const Placement placement = placementOf(mesh.mMaterialIndex);
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices != 3) continue;
      std::array<MeshCorner, 3> corners;
      for (unsigned k = 0; k < 3; ++k) {
        const unsigned i = face.mIndices[k];
        const aiVector3D& p = mesh.mVertices[i];
        const glm::mat4& place = skin.empty() ? scene_from_mesh : skin[i];
        corners[k].position = glm::vec3(place * glm::vec4(p.x, p.y, p.z, 1.0f));
        if (mesh.HasNormals()) {
          const aiVector3D& n = mesh.mNormals[i];
          const glm::mat3 to = skin.empty() ? of_normals : glm::mat3(normalsFrom(glm::mat3(place)));
          corners[k].normal = to * glm::vec3(n.x, n.y, n.z);
        }
        if (mesh.HasTextureCoords(placement.set)) {
          const aiVector3D& uv = mesh.mTextureCoords[placement.set][i];
          corners[k].uv = glm::vec2(placement.transform * glm::vec3(uv.x, uv.y, 1.0f));
        }
        if (!mesh.HasVertexColors(0)) continue;
        const aiColor4D& color = mesh.mColors[0][i];
        corners[k].color = linearColor({color.r, color.g, color.b});
      }
      if (!mesh.HasNormals() && glm::determinant(turn) < 0.0f) std::swap(corners[1], corners[2]);
      builder_.add(corners, mesh.mMaterialIndex);
    }
  }

  /// Where a node is in the scene, by all nodes above it but the root.
  glm::mat4 sceneFrom(const aiNode* node) const {
    glm::mat4 place(1.0f);
    for (; node != nullptr && node != scene_.mRootNode; node = node->mParent) {
      place = matrixOf(node->mTransformation) * place;
    }
    return place;
  }

  /// From each vertex of a mesh with bones to the scene; empty for other meshes.
  std::vector<glm::mat4> skinOf(const aiMesh& mesh, const glm::mat4& scene_from_mesh) const {
    if (mesh.mNumBones == 0) return {};
    std::vector<glm::mat4> places(mesh.mNumVertices, glm::mat4(0.0f));
    std::vector<float> totals(mesh.mNumVertices, 0.0f);
    for (unsigned b = 0; b < mesh.mNumBones; ++b) {
      const aiBone& bone = *mesh.mBones[b];
      const aiNode* const node = scene_.mRootNode->FindNode(bone.mName);
      if (node == nullptr) continue;
      const glm::mat4 place = sceneFrom(node) * matrixOf(bone.mOffsetMatrix);
      for (unsigned w = 0; w < bone.mNumWeights; ++w) {
        const aiVertexWeight& weight = bone.mWeights[w];
        places.at(weight.mVertexId) += weight.mWeight * place;
        totals[weight.mVertexId] += weight.mWeight;
      }
    }
    for (std::size_t v = 0; v < places.size(); ++v) {
      places[v] = totals[v] > 0.0f ? places[v] / totals[v] : scene_from_mesh;
    }
    return places;
  }

  /// Physically based materials have another key than those of Phong.
  static aiTextureType colorTextureOf(const aiMaterial& material) {
    return material.GetTextureCount(aiTextureType_DIFFUSE) > 0 ? aiTextureType_DIFFUSE
                                                               : aiTextureType_BASE_COLOR;
  }

  /// The set of texture coordinates, and what is done to these.
  struct Placement {
    unsigned set = 0;
    glm::mat3 transform{1.0f};
  };

  Placement placementOf(unsigned number) const {
    Placement placement;
    if (number >= scene_.mNumMaterials) return placement;
    const aiMaterial& material = *scene_.mMaterials[number];
    const aiTextureType type = colorTextureOf(material);
    int set = 0;
    if (material.Get(AI_MATKEY_UVWSRC(type, 0), set) == aiReturn_SUCCESS) {
      placement.set = static_cast<unsigned>(std::clamp(set, 0, AI_MAX_NUMBER_OF_TEXTURECOORDS - 1));
    }
    aiUVTransform t;
    if (material.Get(AI_MATKEY_UVTRANSFORM(type, 0), t) != aiReturn_SUCCESS) {
      return placement;
    }
    // Turned about the middle, scaled, then moved.
    const float c = std::cos(t.mRotation), s = std::sin(t.mRotation);
    const glm::mat3 turned({c, s, 0.0f}, {-s, c, 0.0f},
                           {0.5f * (1.0f - c + s), 0.5f * (1.0f - c - s), 1.0f});
    const glm::mat3 scaled({t.mScaling.x, 0.0f, 0.0f}, {0.0f, t.mScaling.y, 0.0f},
                           {t.mTranslation.x, t.mTranslation.y, 1.0f});
    placement.transform = scaled * turned;
    return placement;
  }

  ReadMaterial materialOf(std::uint32_t number) {
    ReadMaterial read{.material = {.factor = kPlainSurface}};
    if (number >= scene_.mNumMaterials) return read;
    const aiMaterial& from = *scene_.mMaterials[number];
    MeshMaterial& material = read.material;
    const auto color = [&](const char* key, unsigned type, unsigned index) {
      aiColor4D read_color(-1.0f);
      from.Get(key, type, index, read_color);
      return glm::vec3(read_color.r, read_color.g, read_color.b);
    };
    const auto light = [&](const glm::vec3& rgb) {
      return is_linear_ ? glm::clamp(rgb, 0.0f, 1.0f) : linearColor(rgb);
    };
    const glm::vec3 emitted = light(glm::max(color(AI_MATKEY_COLOR_EMISSIVE), 0.0f));
    glm::vec3 diffuse = color(AI_MATKEY_COLOR_DIFFUSE);
    for (const char* key : {"$clr.base", "$raw.Maya|baseColor", "$raw.3dsMax|Parameters|base_color",
                            "$raw.3dsMax|main|basecolor"}) {
      if (diffuse.x < 0.0f) diffuse = color(key, 0, 0);
    }
    const bool plain = from.GetName() == aiString(AI_DEFAULT_MATERIAL_NAME);
    if (diffuse.x >= 0.0f && !plain) material.factor = light(diffuse);
    const bool glows = builder_.takeLight(diffuse == glm::vec3(0.0f), emitted, material);
    float opacity = 1.0f;
    from.Get(AI_MATKEY_OPACITY, opacity);
    material.opacity = opacity >= 0.0f ? std::min(opacity, 1.0f) : 1.0f;
    aiString name;
    masked_ |= from.GetTexture(aiTextureType_OPACITY, 0, &name) == aiReturn_SUCCESS;
    if (!plain) {
      read.facts.emplace();
      read.facts->name = from.GetName().C_Str();
      read.facts->opacity = material.opacity;
    }
    const aiTextureType type = glows ? aiTextureType_EMISSIVE : colorTextureOf(from);
    if (from.GetTexture(type, 0, &name) != aiReturn_SUCCESS) return read;
    ImageSource source{name.C_Str()};
    const aiTexture* const inside = scene_.GetEmbeddedTexture(name.C_Str());
    if (inside != nullptr && inside->mHeight == 0) {  // the bytes of an image file
      source.bytes = {reinterpret_cast<const unsigned char*>(inside->pcData), inside->mWidth};
    } else {
      source.file = namedFile(path_, source.name);
    }
    if (read.facts) read.facts->textures = {factsOf(source)};
    material.texture = builder_.textures().read(source);
    if (material.texture) material.factor = glm::vec3(1.0f);
    const auto wrapOf = [&](const char* key) {
      int mode = aiTextureMapMode_Wrap;
      from.Get(key, static_cast<unsigned>(type), 0, mode);
      const bool clamped = mode == aiTextureMapMode_Clamp || mode == aiTextureMapMode_Decal;
      return clamped                           ? TextureWrap::clamp
             : mode == aiTextureMapMode_Mirror ? TextureWrap::mirror
                                               : TextureWrap::repeat;
    };
    material.wrap = {wrapOf(_AI_MATKEY_MAPPINGMODE_U_BASE), wrapOf(_AI_MATKEY_MAPPINGMODE_V_BASE)};
    return read;
  }

  /// Centimetres a unit, the upward axis, and who wrote it: Blender writes linear light, and most
  /// others sRGB.
  void takeMetadata(const aiMetadata& metadata, SceneFacts& facts) {
    double unit_cm = 0.0;
    float unit_cm_float = 0.0f;
    if (!metadata.Get("UnitScaleFactor", unit_cm) &&
        metadata.Get("UnitScaleFactor", unit_cm_float)) {
      unit_cm = double{unit_cm_float};
    }
    if (unit_cm > 1e-6 && unit_cm < 1e6) facts.unit_m = 0.01 * unit_cm;
    aiString writer;
    is_linear_ = metadata.Get(AI_METADATA_SOURCE_GENERATOR, writer) &&
                 std::string_view(writer.C_Str()).starts_with("Blender");
    int axis = 0;
    if (metadata.Get("UpAxis", axis) && axis >= 0 && axis <= 2) facts.up_axis = axis;
  }

  std::filesystem::path path_;
  Assimp::Importer importer_;
  const aiScene& scene_;  // of the importer
  MeshBuilder builder_;
  std::size_t parts_ = 0, corners_ = 0;
  bool masked_ = false, has_morphs_ = false, is_linear_ = false;
};

}  // namespace

MeshFile readFbxMesh(const std::filesystem::path& path) { return FbxMesh(path).read(); }

}  // namespace foci

#else

#include "base/input_error.h"

namespace foci {

MeshFile readFbxMesh(const std::filesystem::path& path) {
  throw InputError(path.string(),
                   "is FBX, which this build of foci does not read (it was built without "
                   "libassimp-dev): Blender can export it as glTF");
}

}  // namespace foci

#endif
