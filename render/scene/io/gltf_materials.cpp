// glTF 2.0 (Khronos), section 3.9, with KHR_texture_transform, EXT_texture_webp,
// KHR_texture_basisu, KHR_materials_unlit and KHR_materials_pbrSpecularGlossiness.
#include "render/scene/io/gltf_materials.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "render/scene/io/named_file.h"

namespace foci {
namespace {

using Json = nlohmann::json;

/// An object inside an object; an empty one if there is none.
const Json& objectIn(const Json& object, const char* key) {
  static const Json kEmpty = Json::object();
  const Json* const part = partOf(object, key);
  return part != nullptr ? *part : kEmpty;
}

TextureWrap wrapOf(std::size_t mode) {
  return mode == 33071   ? TextureWrap::clamp
         : mode == 33648 ? TextureWrap::mirror
                         : TextureWrap::repeat;
}

glm::vec3 unitColor(const glm::dvec3& color) {
  return glm::vec3(color.x >= 0.0 ? std::min(color.x, 1.0) : 0.0,
                   color.y >= 0.0 ? std::min(color.y, 1.0) : 0.0,
                   color.z >= 0.0 ? std::min(color.z, 1.0) : 0.0);
}

std::string nameOf(const Json& object) {
  const auto name = object.find("name");
  return name != object.end() && name->is_string() ? name->get<std::string>() : "";
}

}  // namespace

/// The colour of a material, and its texture; an empty object if it has none.
struct GltfMaterials::Color {
  glm::vec3 factor{1.0f}, emitted{0.0f};
  float alpha = 1.0f;
  const Json* texture = nullptr;  // not null
  bool glows = false;             // black but for the light that it emits
};

GltfMaterials::GltfMaterials(const GltfDocument& gltf, MeshBuilder& builder)
    : gltf_(gltf), builder_(builder) {
  plain_ = static_cast<std::uint32_t>(arrayIn(gltf.json(), "materials").size());
  const bool basis = std::ranges::any_of(arrayIn(gltf.json(), "textures"), [](const Json& texture) {
    return extensionOf(texture, "KHR_texture_basisu") != nullptr && !texture.contains("source");
  });
  if (!basis) return;
  builder.remark(
      "textures in KTX2 (KHR_texture_basisu) are left out: make them PNG or JPEG, e.g. with "
      "gltf-transform");
}

std::uint32_t GltfMaterials::numberOf(const Json& primitive) const {
  const std::size_t number = numberIn(gltf_, primitive, "material", plain_);
  return number < plain_ ? static_cast<std::uint32_t>(number) : plain_;
}

GltfMaterials::Color GltfMaterials::colorOf(const Json& material) const {
  Color color;
  const Json* const specular = extensionOf(material, "KHR_materials_pbrSpecularGlossiness");
  const Json& base = specular ? *specular : objectIn(material, "pbrMetallicRoughness");
  const auto factor =
      listIn<4>(base, specular ? "diffuseFactor" : "baseColorFactor", {1.0, 1.0, 1.0, 1.0});
  color.factor = unitColor({factor[0], factor[1], factor[2]});
  color.alpha = static_cast<float>(factor[3] >= 0.0 ? std::min(factor[3], 1.0) : 0.0);
  color.texture = &objectIn(base, specular ? "diffuseTexture" : "baseColorTexture");
  const auto emitted = listIn<3>(material, "emissiveFactor", {0.0, 0.0, 0.0});
  color.emitted = unitColor({emitted[0], emitted[1], emitted[2]});
  color.glows = color.factor == glm::vec3(0.0f) && color.emitted != glm::vec3(0.0f);
  if (color.glows) color.texture = &objectIn(material, "emissiveTexture");
  return color;
}

GltfMaterials::Placement GltfMaterials::placementOf(std::uint32_t number) const {
  const Json* const material = gltf_.entry("materials", number);
  if (material == nullptr) return {};
  const Color color = colorOf(*material);
  const Json& texture = *color.texture;
  Placement placement{.set = numberIn(gltf_, texture, "texCoord", 0), .glows = color.glows};
  const Json* const moved = extensionOf(texture, "KHR_texture_transform");
  if (moved == nullptr) return placement;
  placement.set = numberIn(gltf_, *moved, "texCoord", placement.set);
  const auto offset = listIn<2>(*moved, "offset", {0.0, 0.0}),
             scale = listIn<2>(*moved, "scale", {1.0, 1.0});
  const auto stated = moved->find("rotation");
  const double angle_rad =
      stated != moved->end() && stated->is_number() ? stated->get<double>() : 0.0;
  // Scales, turns, then moves; in a frame whose v points downwards, (u, v) turns towards (v, -u).
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  placement.transform = glm::dmat3(glm::dvec3(scale[0] * c, -scale[0] * s, 0.0),
                                   glm::dvec3(scale[1] * s, scale[1] * c, 0.0),
                                   glm::dvec3(offset[0], offset[1], 1.0));
  return placement;
}

ImageSource GltfMaterials::imageOf(const Json& texture) {
  const Json* const entry = gltf_.entry("textures", texture, "index");
  if (entry == nullptr) return {};
  const Json* image = gltf_.entry("images", *entry, "source");
  if (const Json* const webp = extensionOf(*entry, "EXT_texture_webp"); webp && !image) {
    image = gltf_.entry("images", *webp, "source");
  }
  if (image == nullptr) return {};
  ImageSource source{nameOf(*image)};
  if (const auto uri = image->find("uri"); uri != image->end() && uri->is_string()) {
    const auto name = uri->get<std::string>();
    if (auto data = GltfDocument::dataOf(name)) {
      source.bytes = images_.emplace_back(std::move(*data));
    } else {
      source.name = name;
      source.file = namedFile(gltf_.path(), name);
      if (!source.file) {
        source.name = percentDecoded(name);
        source.file = namedFile(gltf_.path(), source.name);
      }
    }
  } else {
    source.bytes = gltf_.view(numberIn(gltf_, *image, "bufferView", kNoEntry));
  }
  if (source.name.empty()) source.name = "image";
  return source;
}

ReadMaterial GltfMaterials::read(std::uint32_t number) {
  const Json* const from = gltf_.entry("materials", number);
  if (from == nullptr) return {.material = {.factor = kPlainSurface, .alpha = AlphaUse::none}};
  ReadMaterial read;
  MeshMaterial& material = read.material;
  const Color color = colorOf(*from);
  builder_.noteLight(color.glows, color.emitted);
  material.factor = color.glows ? color.emitted : color.factor;
  material.tinted = !color.glows;
  material.unlit = color.glows || extensionOf(*from, "KHR_materials_unlit") != nullptr;
  readAlpha(*from, color.glows ? 1.0f : color.alpha, material);
  const ImageSource source = imageOf(*color.texture);
  if (!source.name.empty()) {
    material.texture = builder_.textures().read(source);
    if (const Json* const texture = gltf_.entry("textures", *color.texture, "index")) {
      static const Json kPlainSampler = Json::object();
      const Json* sampler = gltf_.entry("samplers", *texture, "sampler");
      if (sampler == nullptr) sampler = &kPlainSampler;
      material.wrap = {wrapOf(numberIn(gltf_, *sampler, "wrapS", 0)),
                       wrapOf(numberIn(gltf_, *sampler, "wrapT", 0))};
    }
  }
  read.facts.emplace();
  read.facts->name = nameOf(*from);
  read.facts->opacity = material.alpha == AlphaUse::blend ? material.opacity : 1.0f;
  if (!source.name.empty()) read.facts->textures = {factsOf(source)};
  return read;
}

/// @param base_alpha  of the material's colour
void GltfMaterials::readAlpha(const Json& from, float base_alpha, MeshMaterial& material) const {
  const Json mode = from.value("alphaMode", Json("OPAQUE"));
  material.alpha = AlphaUse::none;
  if (mode == "MASK") {  // the cutoff applies to the product with the base colour's alpha
    const auto stated = from.find("alphaCutoff");
    if (stated != from.end() && stated->is_number()) material.cutoff = stated->get<float>();
    if (material.cutoff > 0.0f) material.alpha = AlphaUse::cut;
    material.cutoff =
        base_alpha > 0.0f ? material.cutoff / base_alpha : std::numeric_limits<float>::infinity();
  } else if (mode == "BLEND") {
    material.alpha = AlphaUse::blend;
    material.opacity = base_alpha;
  }
}

}  // namespace foci
