// Wavefront's MTL; glTF 2.0 (Khronos), materials.
#include "render/scene/io/material_reader.h"

#include <assimp/GltfMaterial.h>
#include <assimp/scene.h>

#include <algorithm>
#include <limits>

#include "base/file.h"
#include "render/image/srgb.h"
#include "render/scene/io/gltf_json.h"
#include "render/scene/io/named_file.h"

namespace foci {
namespace {

TextureWrap wrapOf(const aiMaterial& material, const char* key, aiTextureType type) {
  int mode = aiTextureMapMode_Wrap;
  material.Get(key, static_cast<unsigned>(type), 0, mode);
  if (mode == aiTextureMapMode_Mirror) return TextureWrap::mirror;
  const bool clamp = mode == aiTextureMapMode_Clamp || mode == aiTextureMapMode_Decal;
  return clamp ? TextureWrap::clamp : TextureWrap::repeat;
}

bool emits(const aiMaterial& material) {
  aiColor4D light(0.0f);
  return material.Get(AI_MATKEY_COLOR_EMISSIVE, light) == aiReturn_SUCCESS &&
         (light.r > 0.0f || light.g > 0.0f || light.b > 0.0f);
}

}  // namespace

glm::vec3 linearColor(const aiColor4D& color, bool srgb) {
  const auto linear = [&](float x) {
    const float unit = x >= 0.0f ? std::min(x, 1.0f) : 0.0f;
    return srgb ? linearFromSrgb(unit) : unit;
  };
  return {linear(color.r), linear(color.g), linear(color.b)};
}

MaterialReader::MaterialReader(const std::filesystem::path& mesh, const aiScene& scene)
    : path_(mesh),
      scene_(scene),
      gltf_(isGltf(mesh)),
      obj_(lowerExtension(mesh) == ".obj"),
      textures_(mesh) {
  if (obj_) placed_ = placedTextures(mesh);
}

ImageSource MaterialReader::imageSource(const std::string& name) const {
  ImageSource source{name};
  if (const aiTexture* embedded = scene_.GetEmbeddedTexture(name.c_str())) {
    source.bytes = {reinterpret_cast<const unsigned char*>(embedded->pcData), embedded->mWidth};
    return source;
  }
  source.file = namedFile(path_, name);
  if (!source.file && gltf_) source.file = namedFile(path_, percentDecoded(name));
  return source;
}

/// Whether a material is black but for the light that it emits.
bool MaterialReader::glows(const aiMaterial& material) const {
  aiColor4D color(1.0f);
  if (!(gltf_ && material.Get(AI_MATKEY_BASE_COLOR, color) == aiReturn_SUCCESS) &&
      material.Get(AI_MATKEY_COLOR_DIFFUSE, color) != aiReturn_SUCCESS) {
    return false;
  }
  return color.r == 0.0f && color.g == 0.0f && color.b == 0.0f && emits(material);
}

/// The texture of a material's colour.
std::optional<aiTextureType> MaterialReader::colorTexture(const aiMaterial& material) const {
  if (glows(material)) {
    if (material.GetTextureCount(aiTextureType_EMISSIVE) == 0) return std::nullopt;
    return aiTextureType_EMISSIVE;
  }
  for (const aiTextureType type : {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE}) {
    if (material.GetTextureCount(type) > 0) return type;
  }
  return std::nullopt;
}

TexturePlacement MaterialReader::placementOf(unsigned material) const {
  if (material >= scene_.mNumMaterials) return {};
  const aiMaterial& from = *scene_.mMaterials[material];
  if (const auto placed = placed_.find(from.GetName().C_Str()); placed != placed_.end()) {
    return shiftedPlacement(placed->second.scale, placed->second.offset);
  }
  const std::optional<aiTextureType> type = colorTexture(from);
  return type ? texturePlacement(from, *type, gltf_) : TexturePlacement{};
}

/// Whether Assimp gave this material, which is white, to the triangles of a file without one.
bool MaterialReader::isUncoloured(const aiMaterial& material) const {
  const aiString name = material.GetName();
  return name == aiString(AI_DEFAULT_MATERIAL_NAME) ||
         (name.length == 0 && lowerExtension(path_) == ".ply");
}

MeshMaterial MaterialReader::read(unsigned number) {
  const aiMaterial& from = *scene_.mMaterials[number];
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
  } else if (emits(from)) {
    dimmed_ = true;
  }
  material.factor = linearColor(color, !gltf_);
  readAlpha(from, color.a, material);
  aiString name;
  const std::optional<aiTextureType> type = colorTexture(from);
  if (const auto placed = placed_.find(from.GetName().C_Str()); placed != placed_.end()) {
    material.texture = textures_.read(imageSource(placed->second.name));
  } else if (type && from.GetTexture(*type, 0, &name) == aiReturn_SUCCESS) {
    material.texture = textures_.read(imageSource(name.C_Str()));
  }
  if (type) {
    material.wrap = {wrapOf(from, _AI_MATKEY_MAPPINGMODE_U_BASE, *type),
                     wrapOf(from, _AI_MATKEY_MAPPINGMODE_V_BASE, *type)};
  }
  if (material.texture && (!gltf_ || !colored)) material.factor = glm::vec3(1.0f);
  material.tinted = gltf_ && !glows(from) && (material.texture || (colored && !isUncoloured(from)));
  return material;
}

/// @param base_alpha  of the colour of a glTF's material
void MaterialReader::readAlpha(const aiMaterial& from, float base_alpha, MeshMaterial& material) {
  if (!gltf_) {
    float opacity = 1.0f;
    from.Get(AI_MATKEY_OPACITY, opacity);
    material.opacity = opacity >= 0.0f ? std::min(opacity, 1.0f) : 1.0f;
    aiString name;
    if (from.GetTexture(aiTextureType_OPACITY, 0, &name) != aiReturn_SUCCESS) return;
    if (obj_) {
      material.mask = textures_.readMask(imageSource(name.C_Str()));
    } else {
      masked_ = true;
    }
    return;
  }
  aiString mode;
  from.Get(AI_MATKEY_GLTF_ALPHAMODE, mode);
  const float alpha = base_alpha >= 0.0f ? std::min(base_alpha, 1.0f) : 1.0f;
  if (mode == aiString("MASK")) {  // the cutoff applies to the product with the base colour's alpha
    float cutoff = material.cutoff;
    from.Get(AI_MATKEY_GLTF_ALPHACUTOFF, cutoff);
    const bool holes = cutoff > 0.0f;
    material.alpha = holes ? AlphaUse::cut : AlphaUse::none;
    material.cutoff = alpha > 0.0f ? cutoff / alpha : std::numeric_limits<float>::infinity();
  } else if (mode == aiString("BLEND")) {
    material.alpha = AlphaUse::blend;
    material.opacity = alpha;
  } else {
    material.alpha = AlphaUse::none;
  }
}

std::vector<std::string> MaterialReader::remarks() const {
  std::vector<std::string> remarks = textures_.remarks();
  if (glowing_) {
    remarks.emplace_back(
        "materials that are black but emit light have the colour of that light; they light nothing "
        "else");
  }
  if (dimmed_) {
    remarks.emplace_back(
        "materials that emit light and have a colour are shown in that colour, without the light");
  }
  if (masked_) {
    remarks.emplace_back(
        "materials with a mask of opacity are shown without it; a texture with alpha cuts holes");
  }
  return remarks;
}

}  // namespace foci
