#include "render/scene/io/gltf_shape.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/input_error.h"

namespace foci {
namespace {

using JsonValue = nlohmann::json;

constexpr std::size_t kNoEntry = SIZE_MAX;

/// The numbers of a list; `otherwise` if there is none of this length.
template <std::size_t N>
std::array<double, N> listOf(const JsonValue& node, const char* key,
                             const std::array<double, N>& otherwise) {
  const auto found = node.find(key);
  if (found == node.end() || !found->is_array() || found->size() != N) return otherwise;
  return found->get<std::array<double, N>>();
}

template <class Number>
glm::dmat4 matrixOf(const Number* columns) {
  glm::dmat4 matrix;
  for (int c = 0; c < 4; ++c) {
    for (int r = 0; r < 4; ++r) matrix[c][r] = static_cast<double>(columns[4 * c + r]);
  }
  return matrix;
}

/// From a node to its parent.
glm::dmat4 localOf(const JsonValue& node) {
  if (node.contains("matrix")) {
    const auto all = listOf<16>(node, "matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1});
    return matrixOf(all.data());
  }
  const auto t = listOf<3>(node, "translation", {0, 0, 0}), s = listOf<3>(node, "scale", {1, 1, 1});
  const auto q = listOf<4>(node, "rotation", {0, 0, 0, 1});
  glm::dmat4 matrix = glm::mat4_cast(glm::normalize(glm::dquat(q[3], q[0], q[1], q[2])));
  for (int c = 0; c < 3; ++c) matrix[c] *= s[static_cast<std::size_t>(c)];
  matrix[3] = {t[0], t[1], t[2], 1.0};
  return matrix;
}

/// Joint matrices of a skin, G_j B_j.
using Joints = std::vector<glm::mat4>;

class Shapes {
 public:
  Shapes(const std::filesystem::path& path, JsonValue& json, GltfAccessors& accessors)
      : path_(path), json_(json), accessors_(accessors) {}

  bool apply() {
    if (!json_.contains("nodes") || !json_["nodes"].is_array()) return false;
    findParents();
    countUsers();
    bool changed = false;
    const std::size_t count = json_["nodes"].size();
    for (std::size_t n = 0; n < count; ++n) changed |= applyTo(n);
    changed |= json_.erase("skins") > 0;  // Assimp crashes where matrices are missing
    for (JsonValue& node : json_["nodes"]) changed |= node.is_object() && node.erase("skin") > 0;
    return changed;
  }

 private:
  /// @return whether the node's mesh has another shape now
  bool applyTo(std::size_t number) {
    const JsonValue node = json_["nodes"][number];
    const JsonValue* const mesh = listEntry(json_, "meshes", numberIn(node, "mesh", kNoEntry));
    const JsonValue* const skin = listEntry(json_, "skins", numberIn(node, "skin", kNoEntry));
    if (mesh == nullptr) return false;
    std::optional<JsonValue> shaped;
    try {
      const std::vector<float> weights = weightsOf(node.contains("weights") ? node : *mesh);
      if (skin == nullptr && weights.empty()) return false;
      const std::optional<Joints> joints = skin ? jointsOf(*skin) : Joints{};
      if (joints) shaped = shapedMesh(*mesh, weights, skin ? &*joints : nullptr);
    } catch (const JsonValue::exception&) {
      shaped.reset();  // a part is missing, or of another type than glTF states
    }
    if (!shaped) {
      throw InputError(path_.string(),
                       std::string(skin ? "the skin" : "a morph target") + " of node " +
                           std::to_string(number) +
                           " cannot be read: is a buffer's file missing? else export it again");
    }
    replace(number, std::move(*shaped), skin != nullptr);
    return true;
  }

  void countUsers() {
    for (const JsonValue& node : json_["nodes"]) ++users_[numberIn(node, "mesh", kNoEntry)];
  }

  void findParents() {
    parents_.assign(json_["nodes"].size(), kNoEntry);
    for (std::size_t n = 0; n < parents_.size(); ++n) {
      const JsonValue& node = json_["nodes"][n];
      if (!node.is_object() || !node.contains("children")) continue;
      for (const JsonValue& child : node.at("children")) {
        if (child.is_number_unsigned() && child < parents_.size()) {
          parents_[child.get<std::size_t>()] = n;
        }
      }
    }
  }

  /// Calls `visit` with a node and all above it. A circle, which glTF forbids, ends.
  template <class Visit>
  void upwards(std::size_t node, const Visit& visit) const {
    for (std::size_t step = 0; node != kNoEntry && step < parents_.size(); ++step) {
      visit(node);
      node = parents_[node];
    }
  }

  glm::dmat4 placeOf(std::size_t node) const {
    glm::dmat4 place(1.0);
    upwards(node, [&](std::size_t at) { place = localOf(json_["nodes"][at]) * place; });
    return place;
  }

  /// Weights of morph targets; empty if all are zero.
  static std::vector<float> weightsOf(const JsonValue& entry) {
    std::vector<float> weights;
    bool any = false;
    for (const JsonValue& weight : entry.value("weights", JsonValue::array())) {
      weights.push_back(weight.get<float>());
      any |= weights.back() != 0.0f;
    }
    return any ? weights : std::vector<float>();
  }

  std::optional<Joints> jointsOf(const JsonValue& skin) {
    std::vector<float> bind;
    if (const std::size_t matrices = numberIn(skin, "inverseBindMatrices", kNoEntry);
        matrices != kNoEntry) {
      auto read = accessors_.valuesOf(matrices);
      if (!read) return std::nullopt;
      bind = std::move(*read);
    }
    Joints joints;
    for (const JsonValue& each : skin.at("joints")) {
      const auto node = each.get<std::size_t>();
      if (node >= parents_.size()) return std::nullopt;
      glm::dmat4 joint = placeOf(node);
      if (const std::size_t first = 16 * joints.size(); first + 16 <= bind.size()) {
        joint *= matrixOf(bind.data() + first);
      }
      joints.emplace_back(joint);
    }
    return joints;
  }

  /// @param joints  null: no skin
  std::optional<JsonValue> shapedMesh(JsonValue mesh, const std::vector<float>& weights,
                                      const Joints* joints) {
    std::map<std::string, JsonValue> shaped;  // primitives may share their vertices
    for (JsonValue& primitive : mesh.at("primitives")) {
      const JsonValue targets = primitive.value("targets", JsonValue::array());
      const std::string key = primitive.at("attributes").dump() + targets.dump();
      auto found = shaped.find(key);
      if (found == shaped.end()) {
        auto attributes = shapedAttributes(primitive.at("attributes"), targets, weights, joints);
        if (!attributes) return std::nullopt;
        found = shaped.emplace(key, std::move(*attributes)).first;
      }
      primitive["attributes"] = found->second;
      primitive.erase("targets");
    }
    mesh.erase("weights");
    return mesh;
  }

  std::optional<JsonValue> shapedAttributes(JsonValue attributes, const JsonValue& targets,
                                            const std::vector<float>& weights,
                                            const Joints* joints) {
    auto positions = accessors_.valuesOf(numberIn(attributes, "POSITION", kNoEntry));
    if (!positions) return std::nullopt;
    for (std::size_t t = 0; t < std::min(weights.size(), targets.size()); ++t) {
      const std::size_t target = numberIn(targets[t], "POSITION", kNoEntry);
      if (weights[t] == 0.0f || target == kNoEntry) continue;
      const auto moves = accessors_.valuesOf(target);
      if (!moves || moves->size() != positions->size()) return std::nullopt;
      for (std::size_t i = 0; i < moves->size(); ++i) (*positions)[i] += weights[t] * (*moves)[i];
    }
    if (joints != nullptr) {
      const auto blended = blendedJoints(attributes, positions->size() / 3, *joints);
      if (!blended) return std::nullopt;
      std::optional<std::vector<float>> normals;
      if (attributes.contains("NORMAL")) {
        normals = accessors_.valuesOf(numberIn(attributes, "NORMAL", kNoEntry));
        if (!normals || normals->size() != positions->size()) return std::nullopt;
      }
      for (std::size_t i = 0; i < blended->size(); ++i) {
        const glm::mat4& to = (*blended)[i];
        moveTo(&(*positions)[3 * i], [&](const glm::vec3& v) { return to * glm::vec4(v, 1.0f); });
        if (!normals) continue;
        const glm::mat3 turn(to);
        const bool flat = glm::determinant(turn) == 0.0f;
        const glm::mat3 of_normals = flat ? turn : glm::transpose(glm::inverse(turn));
        moveTo(&(*normals)[3 * i], [&](const glm::vec3& v) { return of_normals * v; });
      }
      if (normals) attributes["NORMAL"] = accessors_.add(*normals);
    }
    attributes["POSITION"] = accessors_.add(*positions);
    for (const char* key : {"TANGENT", "JOINTS_0", "WEIGHTS_0", "JOINTS_1", "WEIGHTS_1"}) {
      attributes.erase(key);
    }
    return attributes;
  }

  template <class Move>
  static void moveTo(float* at, const Move& move) {
    const glm::vec3 moved(move(glm::vec3(at[0], at[1], at[2])));
    for (int k = 0; k < 3; ++k) at[k] = moved[k];
  }

  /// By vertex, the mean of its joints. A vertex without weights follows the first joint.
  std::optional<std::vector<glm::mat4>> blendedJoints(const JsonValue& attributes,
                                                      std::size_t vertices, const Joints& joints) {
    std::vector<glm::mat4> sums(vertices, glm::mat4(0.0f));
    std::vector<float> totals(vertices, 0.0f);
    for (int set = 0; attributes.contains("JOINTS_" + std::to_string(set)); ++set) {
      const std::string suffix = std::to_string(set);
      const auto names =
          accessors_.valuesOf(numberIn(attributes, ("JOINTS_" + suffix).c_str(), kNoEntry));
      const auto weights =
          accessors_.valuesOf(numberIn(attributes, ("WEIGHTS_" + suffix).c_str(), kNoEntry));
      if (!names || !weights || names->size() != 4 * vertices || weights->size() != 4 * vertices) {
        return std::nullopt;
      }
      for (std::size_t i = 0; i < weights->size(); ++i) {
        if (!((*weights)[i] > 0.0f)) continue;
        const auto joint = static_cast<std::size_t>((*names)[i]);
        if (joint >= joints.size()) refuseJoint(joint, joints.size());
        sums[i / 4] += (*weights)[i] * joints[joint];
        totals[i / 4] += (*weights)[i];
      }
    }
    for (std::size_t v = 0; v < vertices; ++v) {
      if (totals[v] > 0.0f)
        sums[v] /= totals[v];
      else
        sums[v] = joints.empty() ? glm::mat4(1.0f) : joints[0];
    }
    return sums;
  }

  [[noreturn]] void refuseJoint(std::size_t joint, std::size_t count) const {
    throw InputError(path_.string(), "a vertex names joint " + std::to_string(joint) +
                                         " of a skin that has " + std::to_string(count) +
                                         ": export the file again");
  }

  /// Puts the mesh in the place of a node's, or at the root of the node's scenes.
  void replace(std::size_t number, JsonValue mesh, bool at_root) {
    JsonValue& node = json_["nodes"][number];
    if (const auto own = node["mesh"].get<std::size_t>(); users_[own] == 1) {
      json_["meshes"][own] = std::move(mesh);
    } else {
      node["mesh"] = json_["meshes"].size();
      json_["meshes"].push_back(std::move(mesh));
    }
    node.erase("weights");
    if (!at_root || !json_.contains("scenes")) return;
    JsonValue moved = {{"mesh", node["mesh"]}};
    if (node.contains("name")) moved["name"] = node["name"];
    node.erase("mesh");
    std::size_t root = number;
    upwards(number, [&](std::size_t at) { root = at; });
    for (JsonValue& scene : json_["scenes"]) {
      if (!scene.is_object() || !scene.contains("nodes") || !scene["nodes"].is_array()) continue;
      JsonValue& roots = scene["nodes"];
      if (std::find(roots.begin(), roots.end(), JsonValue(root)) != roots.end()) {
        roots.push_back(json_["nodes"].size());
      }
    }
    json_["nodes"].push_back(std::move(moved));
  }

  const std::filesystem::path& path_;
  JsonValue& json_;
  GltfAccessors& accessors_;
  std::vector<std::size_t> parents_;            // by node
  std::map<std::size_t, std::size_t> users_{};  // of each mesh, how many nodes
};

}  // namespace

bool applyShapes(const std::filesystem::path& path, JsonValue& json, GltfAccessors& accessors) {
  return Shapes(path, json, accessors).apply();
}

}  // namespace foci
