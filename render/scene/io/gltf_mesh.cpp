// glTF 2.0 (Khronos): the meshes of a scene, with morph targets by their weights (3.7.2.2) and
// skins by the joints' nodes (3.7.3.3).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <deque>
#include <glm/glm.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/text.h"
#include "render/scene/io/gltf_document.h"
#include "render/scene/io/gltf_scene.h"
#include "render/scene/io/mesh_builder.h"
#include "render/scene/io/mesh_formats.h"

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

glm::vec3 unitColor(const double* rgb) {
  return glm::vec3(glm::clamp(glm::make_vec3(rgb), 0.0, 1.0));
}

/// The materials of a glTF (section 3.9), with KHR_texture_transform, EXT_texture_webp,
/// KHR_texture_basisu, KHR_materials_unlit and KHR_materials_pbrSpecularGlossiness.
class GltfMaterials {
 public:
  /// @param builder  reads the textures; has to stay, as the document
  GltfMaterials(const GltfDocument& gltf, MeshBuilder& builder) : gltf_(gltf), builder_(builder) {
    plain_ = static_cast<std::uint32_t>(arrayIn(gltf.json(), "materials").size());
    const bool unread =
        std::ranges::any_of(arrayIn(gltf.json(), "textures"), [](const Json& texture) {
          return !texture.contains("source") && texture.contains("extensions") &&
                 extensionOf(texture, "EXT_texture_webp") == nullptr;
        });
    if (!unread) return;
    builder.remark(
        "textures in KTX2, AVIF or DDS alone are left out: make them PNG or JPEG, e.g. with "
        "gltf-transform");
  }

  /// The number of a primitive's material; that of a plain one if it names none.
  std::uint32_t numberOf(const Json& primitive) const {
    const std::size_t number = numberIn(gltf_, primitive, "material", plain_);
    return number < plain_ ? static_cast<std::uint32_t>(number) : plain_;
  }

  /// How a material places the texture of its colour: the set of texture coordinates, and what is
  /// done to these, whose v points downwards.
  struct Placement {
    std::size_t set = 0;
    glm::mat3 transform{1.0f};
    bool glows = false;  ///< the material is black but for the light that it emits

    /// The result's v points upwards.
    glm::vec2 of(const glm::vec2& uv) const {
      const glm::vec3 placed = transform * glm::vec3(uv, 1.0f);
      return {placed.x, 1.0f - placed.y};
    }
  };

  Placement placementOf(std::uint32_t number) const {
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
    const double angle_rad = fractionIn(*moved, "rotation", 0.0);
    // Scales, turns, then moves; in a frame whose v points downwards, (u, v) turns towards (v, -u).
    const double c = std::cos(angle_rad), s = std::sin(angle_rad);
    placement.transform = glm::dmat3(glm::dvec3(scale[0] * c, -scale[0] * s, 0.0),
                                     glm::dvec3(scale[1] * s, scale[1] * c, 0.0),
                                     glm::dvec3(offset[0], offset[1], 1.0));
    return placement;
  }

  ReadMaterial read(std::uint32_t number) {
    const Json* const from = gltf_.entry("materials", number);
    if (from == nullptr) return {.material = {.factor = kPlainSurface, .alpha = AlphaUse::none}};
    ReadMaterial read;
    MeshMaterial& material = read.material;
    const Color color = colorOf(*from);
    material.factor = color.factor;
    material.tinted = !builder_.takeLight(color.glows, color.emitted, material);
    material.unlit |= extensionOf(*from, "KHR_materials_unlit") != nullptr;
    readAlpha(*from, color.glows ? 1.0f : color.alpha, material);
    remarkGlass(*from, material);
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
    read.facts->name = textIn(*from, "name").value_or("");
    read.facts->opacity = material.alpha == AlphaUse::blend ? material.opacity : 1.0f;
    if (!source.name.empty()) read.facts->textures = {factsOf(source)};
    return read;
  }

 private:
  /// The colour of a material, and its texture; an empty object if it has none.
  struct Color {
    glm::vec3 factor{1.0f}, emitted{0.0f};
    float alpha = 1.0f;
    const Json* texture = nullptr;  // not null
    bool glows = false;             // black but for the light that it emits
  };

  Color colorOf(const Json& material) const {
    Color color;
    const Json* const specular = extensionOf(material, "KHR_materials_pbrSpecularGlossiness");
    const Json& base = specular ? *specular : objectIn(material, "pbrMetallicRoughness");
    const auto factor =
        listIn<4>(base, specular ? "diffuseFactor" : "baseColorFactor", {1.0, 1.0, 1.0, 1.0});
    color.factor = unitColor(factor.data());
    color.alpha = static_cast<float>(std::clamp(factor[3], 0.0, 1.0));
    color.texture = &objectIn(base, specular ? "diffuseTexture" : "baseColorTexture");
    const auto emitted = listIn<3>(material, "emissiveFactor", {0.0, 0.0, 0.0});
    color.emitted = unitColor(emitted.data());
    color.glows = color.factor == glm::vec3(0.0f) && color.emitted != glm::vec3(0.0f);
    if (color.glows) color.texture = &objectIn(material, "emissiveTexture");
    return color;
  }

  ImageSource imageOf(const Json& texture) {
    const Json* const entry = gltf_.entry("textures", texture, "index");
    if (entry == nullptr) return {};
    const Json* image = gltf_.entry("images", *entry, "source");
    if (const Json* const webp = extensionOf(*entry, "EXT_texture_webp"); webp && !image) {
      image = gltf_.entry("images", *webp, "source");
    }
    if (image == nullptr) return {};
    ImageSource source{textIn(*image, "name").value_or("")};
    if (const auto uri = textIn(*image, "uri")) {
      if (auto data = GltfDocument::dataOf(*uri)) {
        source.bytes = images_.emplace_back(std::move(*data));
      } else {
        source.file = fileOfUri(gltf_.path(), *uri);
        source.name = percentDecoded(*uri);
      }
    } else {
      source.bytes = gltf_.view(numberIn(gltf_, *image, "bufferView", kNoEntry));
    }
    if (source.name.empty()) source.name = "image";
    return source;
  }

  /// @param base_alpha  of the material's colour
  void readAlpha(const Json& from, float base_alpha, MeshMaterial& material) const {
    const Json mode = from.value("alphaMode", Json("OPAQUE"));
    material.alpha = AlphaUse::none;
    if (mode == "MASK") {  // the cutoff applies to the product with the base colour's alpha
      material.cutoff =
          static_cast<float>(fractionIn(from, "alphaCutoff", double{material.cutoff}));
      if (material.cutoff > 0.0f) material.alpha = AlphaUse::cut;
      material.cutoff =
          base_alpha > 0.0f ? material.cutoff / base_alpha : std::numeric_limits<float>::infinity();
    } else if (mode == "BLEND") {
      material.alpha = AlphaUse::blend;
      material.opacity = base_alpha;
    }
  }

  void remarkGlass(const Json& from, const MeshMaterial& material) {
    const Json* const glass = extensionOf(from, "KHR_materials_transmission");
    if (glass == nullptr || material.alpha == AlphaUse::blend) return;
    if (!(fractionIn(*glass, "transmissionFactor", 0.0) > 0.0)) return;
    if (std::exchange(has_glass_, true)) return;
    builder_.remark(
        "materials of glass (KHR_materials_transmission) are shown opaque: export them with "
        "alphaMode BLEND to see through them");
  }

  const GltfDocument& gltf_;
  MeshBuilder& builder_;
  bool has_glass_ = false;
  std::uint32_t plain_ = 0;                        // the number after the last
  std::deque<std::vector<unsigned char>> images_;  // inside URIs; their places stay
};

// Exporters need far fewer; 2^26 corners take about 3 GB.
constexpr double kMaxCorners = 1 << 26;

std::vector<glm::vec3> vectorsOf(std::span<const float> floats) {
  std::vector<glm::vec3> vectors(floats.size() / 3);
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    vectors[i] = {floats[3 * i], floats[3 * i + 1], floats[3 * i + 2]};
  }
  return vectors;
}

/// A primitive as the file has it.
struct GltfPart {
  std::vector<glm::vec3> positions{}, normals{};  // normals: empty for none
  std::vector<glm::vec2> uv{};
  std::vector<float> colors{};  // of `channels` each
  std::size_t channels = 0;
  std::vector<std::uint32_t> triangles{};
  std::uint32_t material = 0;
  bool glows = false;  // see `GltfMaterials::Placement`
};

class GltfMeshReader {
 public:
  explicit GltfMeshReader(const GltfDocument& gltf)
      : gltf_(gltf), nodes_(gltf), builder_(gltf.path()), materials_(gltf, builder_) {}

  MeshFile read(bool points_are_kept) {
    try {
      const std::vector<GltfPlace> places = placesOf(gltf_, builder_.remarks());
      refuseTooLarge(places);
      for (const GltfPlace& place : places) addPlace(place);
      builder_.remarkCount(missing_, "triangle", "with a vertex that is not there: left out");
      builder_.remarkLeftOut(points_are_kept ? 0 : points_, lines_);
      return builder_.finish({.kind = SceneKind::gltf, .unit_m = 1.0},
                             [&](std::uint32_t number) { return materials_.read(number); });
    } catch (const Json::exception&) {
      gltf_.refuse("has parts of another type than glTF states: export it again");
    }
  }

 private:
  /// The primitives of a mesh, which are objects.
  std::vector<const Json*> primitivesOf(const Json& mesh) const {
    std::vector<const Json*> primitives;
    for (const Json& each : arrayIn(mesh, "primitives")) {
      if (each.is_object()) primitives.push_back(&each);
    }
    return primitives;
  }

  void refuseTooLarge(const std::vector<GltfPlace>& places) {
    std::map<std::size_t, double> corners;  // by mesh
    double all = 0.0;
    for (const GltfPlace& place : places) {
      const auto [at, is_new] = corners.try_emplace(place.mesh, 0.0);
      if (is_new) {
        for (const Json* primitive : primitivesOf(*gltf_.entry("meshes", place.mesh))) {
          at->second += cornersOf(*primitive);
        }
      }
      ++uses_[place.mesh];
      all += at->second;
    }
    if (all <= kMaxCorners) return;
    gltf_.refuse("its scene graph has ", (all < 1e15 ? thousands(all) : "over 1e15"),
                 " corners of triangles: expected at most ", thousands(kMaxCorners));
  }

  double cornersOf(const Json& primitive) const {
    const std::array<std::size_t, 2> accessors = {
        numberIn(gltf_, primitive.value("attributes", Json()), "POSITION", kNoEntry),
        numberIn(gltf_, primitive, "indices", kNoEntry)};
    double corners = 0.0;
    for (const std::size_t accessor : accessors) {
      if (gltf_.entry("accessors", accessor) == nullptr) continue;
      corners = std::max(corners, static_cast<double>(gltf_.countOf(accessor)));
    }
    return corners;
  }

  void addPlace(const GltfPlace& place) {
    builder_.useObject(builder_.addObject(place.name));
    const auto primitives = primitivesOf(*gltf_.entry("meshes", place.mesh));
    for (std::size_t i = 0; i < primitives.size(); ++i) {
      const std::size_t mode = modeOf(gltf_, *primitives[i]);
      if (extensionOf(*primitives[i], "KHR_gaussian_splatting") != nullptr) continue;
      if (mode < 4) {
        const auto corners = static_cast<std::uint64_t>(cornersOf(*primitives[i]));
        (mode == 0 ? points_ : lines_) += mode == 1 ? corners / 2 : corners;
        continue;
      }
      const auto key = std::pair(place.mesh, i);
      if (const auto known = parts_.find(key); known != parts_.end()) {
        addPart(place, *primitives[i], known->second);
        continue;
      }
      GltfPart part = readPart(*primitives[i]);
      addPart(place, *primitives[i], part);
      if (uses_[place.mesh] > 1) parts_.emplace(key, std::move(part));
    }
  }

  GltfPart readPart(const Json& json) {
    const GltfPrimitive primitive(gltf_, json);
    GltfPart part{.material = materials_.numberOf(json)};
    part.positions = vectorsOf(primitive.floats("POSITION", 3));
    part.normals = vectorsOf(primitive.floats("NORMAL", 3));
    part.triangles = primitive.triangles();
    const GltfMaterials::Placement placement = materials_.placementOf(part.material);
    // The colours of vertices tint the material's, and not the light that it emits.
    part.glows = placement.glows;
    part.channels = placement.glows ? 0 : primitive.componentsOf("COLOR_0");
    if (part.channels > 0) part.colors = primitive.floats("COLOR_0", part.channels == 4 ? 4 : 3);
    const auto uv = primitive.floats("TEXCOORD_" + std::to_string(placement.set), 2);
    for (std::size_t i = 0; i < uv.size(); i += 2) {
      part.uv.push_back(placement.of({uv[i], uv[i + 1]}));
    }
    return part;
  }

  void addPart(const GltfPlace& place, const Json& json, const GltfPart& part) {
    std::vector<glm::vec3> positions = part.positions, normals = part.normals;
    applyWeights(place, json, positions);
    if (place.skin) {
      applySkin(place, json, positions, normals);
    } else if (place.scene_from_mesh != glm::dmat4(1.0)) {
      for (glm::vec3& p : positions) p = glm::vec3(place.scene_from_mesh * glm::dvec4(p, 1.0));
      const glm::dmat3 of_normals = normalsFrom(glm::dmat3(place.scene_from_mesh));
      for (glm::vec3& n : normals) n = glm::vec3(of_normals * glm::dvec3(n));
    }
    const bool mirrored = glm::determinant(glm::dmat3(place.scene_from_mesh)) < 0.0;
    for (std::size_t i = 0; i + 2 < part.triangles.size(); i += 3) {
      std::array<MeshCorner, 3> corners;
      bool there = true;
      for (std::size_t k = 0; k < 3 && there; ++k) {
        const std::size_t v = part.triangles[i + k];
        there = v < positions.size();
        if (!there) break;
        MeshCorner& corner = corners[mirrored ? 2 - k : k];
        corner.position = positions[v];
        if (!normals.empty()) corner.normal = normals[v];
        if (!part.uv.empty()) corner.uv = part.uv[v];
        if (place.tint && !part.glows) corner.color = *place.tint;
        if (part.colors.empty()) continue;
        const float* const color = &part.colors[v * part.channels];
        corner.color = place.tint.value_or(glm::vec3(1.0f)) *
                       glm::clamp(glm::vec3(color[0], color[1], color[2]), 0.0f, 1.0f);
        if (part.channels == 4) corner.alpha = color[3];
      }
      if (there) {
        builder_.add(corners, part.material);
      } else {
        ++missing_;
      }
    }
  }

  [[noreturn]] void refuseShape(const GltfPlace& place, const char* what) const {
    gltf_.refuse(what, " of node ", place.node,
                 " cannot be read: is a buffer's file missing? else export it again");
  }

  /// v' = v + sum of w_t d_t over the targets t
  void applyWeights(const GltfPlace& place, const Json& json,
                    std::vector<glm::vec3>& positions) const {
    const Json& targets = arrayIn(json, "targets");
    if (targets.empty()) return;
    const Json& node = *gltf_.entry("nodes", place.node);
    const Json weights = (node.contains("weights") ? node : *gltf_.entry("meshes", place.mesh))
                             .value("weights", Json::array());
    for (std::size_t t = 0; t < std::min(weights.size(), targets.size()); ++t) {
      const float weight = weights[t].get<float>();
      const std::size_t target = numberIn(gltf_, targets[t], "POSITION", kNoEntry);
      if (weight == 0.0f || target == kNoEntry) continue;
      const auto moves = vectorsOf(gltf_.floats(target, 3));
      if (moves.size() != positions.size()) refuseShape(place, "a morph target");
      for (std::size_t i = 0; i < moves.size(); ++i) positions[i] += weight * moves[i];
    }
  }

  /// v'' = sum of w_j G_j B_j v' over the joints j, with G_j the joint's place in the scene and
  /// B_j its inverse bind matrix. Weights are divided by their sum; a vertex without weights
  /// follows the first joint.
  void applySkin(const GltfPlace& place, const Json& json, std::vector<glm::vec3>& positions,
                 std::vector<glm::vec3>& normals) const {
    const std::vector<glm::mat4> joints = jointsOf(place);
    const GltfPrimitive primitive(gltf_, json);
    std::vector<glm::mat4> sums(positions.size(), glm::mat4(0.0f));
    std::vector<float> totals(positions.size(), 0.0f);
    for (int set = 0; primitive.componentsOf("JOINTS_" + std::to_string(set)) > 0; ++set) {
      const auto names = primitive.floats("JOINTS_" + std::to_string(set), 4),
                 weights = primitive.floats("WEIGHTS_" + std::to_string(set), 4);
      if (weights.size() != names.size()) refuseShape(place, "the skin");
      for (std::size_t i = 0; i < weights.size(); ++i) {
        if (!(weights[i] > 0.0f)) continue;
        if (!(names[i] >= 0.0f && names[i] < static_cast<float>(joints.size()))) {
          gltf_.refuse("a vertex names joint ", exactText(double{names[i]}), " of a skin that has ",
                       joints.size(), ": export the file again");
        }
        sums[i / 4] += weights[i] * joints[static_cast<std::size_t>(names[i])];
        totals[i / 4] += weights[i];
      }
    }
    for (std::size_t v = 0; v < positions.size(); ++v) {
      const glm::mat4 to = totals[v] > 0.0f ? sums[v] / totals[v] : joints[0];
      positions[v] = glm::vec3(to * glm::vec4(positions[v], 1.0f));
      if (!normals.empty()) normals[v] = glm::mat3(normalsFrom(glm::mat3(to))) * normals[v];
    }
  }

  std::vector<glm::mat4> jointsOf(const GltfPlace& place) const {
    const Json& skin = *gltf_.entry("skins", *place.skin);
    const Json& list = arrayIn(skin, "joints");
    if (list.empty()) refuseShape(place, "the skin");
    const std::size_t matrices = numberIn(gltf_, skin, "inverseBindMatrices", kNoEntry);
    const auto bind = matrices == kNoEntry ? std::vector<float>() : gltf_.floats(matrices, 16);
    std::vector<glm::mat4> joints;
    for (const Json& each : list) {
      const auto node = each.get<std::size_t>();
      if (node >= nodes_.size()) refuseShape(place, "the skin");
      glm::dmat4 joint = nodes_.sceneFrom(node);
      if (const std::size_t first = 16 * joints.size(); first + 16 <= bind.size()) {
        joint *= glm::dmat4(glm::make_mat4(&bind[first]));
      }
      joints.emplace_back(joint);
    }
    return joints;
  }

  const GltfDocument& gltf_;
  GltfNodes nodes_;
  MeshBuilder builder_;
  GltfMaterials materials_;
  std::map<std::size_t, int> uses_;                                // of each mesh
  std::map<std::pair<std::size_t, std::size_t>, GltfPart> parts_;  // of meshes used repeatedly
  std::uint64_t missing_ = 0, points_ = 0, lines_ = 0;
};

}  // namespace

MeshFile readGltfMesh(const GltfDocument& gltf, bool points_are_kept) {
  return GltfMeshReader(gltf).read(points_are_kept);
}

}  // namespace foci
