// glTF 2.0 (Khronos): the meshes of a scene, with morph targets by their weights (3.7.2.2) and
// skins by the joints' nodes (3.7.3.3).
#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/text.h"
#include "render/scene/io/gltf_materials.h"
#include "render/scene/io/gltf_scene.h"
#include "render/scene/io/mesh_formats.h"

namespace foci {
namespace {

using Json = nlohmann::json;

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
};

class GltfMeshReader {
 public:
  explicit GltfMeshReader(const GltfDocument& gltf)
      : gltf_(gltf), nodes_(gltf), builder_(gltf.path()), materials_(gltf, builder_) {}

  MeshFile read(bool points_are_kept) {
    try {
      const std::vector<GltfPlace> places = placesOf(gltf_);
      refuseTooLarge(places);
      for (const GltfPlace& place : places) addPlace(place);
      builder_.remarkCount(missing_, " triangle names a vertex that is not there: it is left out",
                           " triangles name vertices that are not there: left out");
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
    gltf_.refuse("its scene graph has " + (all < 1e15 ? thousands(all) : "over 1e15") +
                 " corners of triangles: expected at most " + thousands(kMaxCorners));
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
        (mode == 0 ? points_ : lines_) += static_cast<std::uint64_t>(cornersOf(*primitives[i]));
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
        if (part.colors.empty()) continue;
        const float* const color = &part.colors[v * part.channels];
        corner.color = glm::clamp(glm::vec3(color[0], color[1], color[2]), 0.0f, 1.0f);
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
    gltf_.refuse(std::string(what) + " of node " + std::to_string(place.node) +
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

  /// v'' = sum of w_j G_j B_j v' over the joints j, with G_j the joint's place in the scene and B_j
  /// its inverse bind matrix. Weights are divided by their sum; a vertex without weights follows
  /// the first joint.
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
          gltf_.refuse("a vertex names joint " + exactText(double{names[i]}) +
                       " of a skin that has " + std::to_string(joints.size()) +
                       ": export the file again");
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
        glm::dmat4 matrix;
        for (std::size_t i = 0; i < 16; ++i) {
          matrix[static_cast<int>(i / 4)][static_cast<int>(i % 4)] = double{bind[first + i]};
        }
        joint *= matrix;
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
