// glTF 2.0 and 1.0 (Khronos): nodes, meshes and accessors are lists in 2.0, and objects by name in
// 1.0.
#include "render/scene/io/mesh_limits.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "base/input_error.h"
#include "base/text.h"

namespace foci {
namespace {

using Json = nlohmann::json;

// Chosen by hand. Exporters nest nodes below 100 deep; 2^26 corners take Assimp about 4 GB.
constexpr int kMaxNodeDepth = 500;
constexpr double kMaxCorners = 1 << 26;

constexpr int kTriangles = 4;  // mode of a primitive; 5 and 6 are strips and fans

/// The parts of a glTF that decide how large its scene becomes.
class SceneGraph {
 public:
  explicit SceneGraph(const GltfDocument& gltf) : file_(gltf.path.string()), json_(gltf.json) {}

  /// @throws InputError
  void refuseTooLarge() {
    for (const auto& [key, mesh] : items("meshes")) corners_[key] = cornersOf(*mesh);
    double meshes = 0.0;
    for (const auto& [key, corners] : corners_) meshes += corners;
    refuseAbove(meshes, kMaxCorners, "corners of triangles");
    for (const auto& [key, node] : items("nodes")) nodes_[key] = Node{.json = node};
    for (const auto& [key, node] : nodes_) sumUp(key);
    for (const auto& [key, scene] : items("scenes")) {
      double instances = 0.0, corners = 0.0;
      for (const std::string& root : keysIn(*scene, "nodes")) {
        if (const auto node = nodes_.find(root); node != nodes_.end()) {
          instances += node->second.instances;
          corners += node->second.corners;
        }
      }
      refuseAbove(instances, kMaxInstances, "instances of nodes");
      refuseAbove(corners, kMaxCorners, "corners of triangles");
    }
  }

  /// Absent if a part consists of points or lines.
  std::optional<StatedTriangles> statedTriangles() const {
    StatedTriangles stated;
    for (const auto& [key, mesh] : items("meshes")) {
      if (!mesh->is_object() || !mesh->contains("primitives")) continue;
      for (const Json& primitive : mesh->at("primitives")) {
        if (!primitive.is_object() || !primitive.contains("attributes")) return std::nullopt;
        const Json mode = primitive.value("mode", Json(kTriangles));
        if (!mode.is_number_integer() || mode < kTriangles) return std::nullopt;
        const auto corners = static_cast<std::uint64_t>(
            primitive.contains("indices") ? countOf(primitive, "indices")
                                          : countOf(primitive.at("attributes"), "POSITION"));
        stated.triangles +=
            mode == kTriangles ? corners / 3 : std::max<std::uint64_t>(corners, 2) - 2;
        ++stated.parts;
      }
    }
    return stated;
  }

 private:
  struct Node {
    const Json* json = nullptr;
    std::vector<std::string> children{};
    bool entered = false, done = false;
    int height = 1;                         ///< nodes on the longest path down
    double instances = 1.0, corners = 0.0;  ///< of the node and all below it
  };

  void refuseAbove(double count, double most, const char* what) const {
    if (count <= most) return;
    throw InputError(file_, std::string("its scene graph has ") +
                                (count < 1e15 ? thousands(count) : "over 1e15") + " " + what +
                                ": expected at most " + thousands(most));
  }

  /// A reference as a key: a number in glTF 2.0, a name in 1.0.
  static std::string keyOf(const Json& reference) {
    if (reference.is_string()) return reference.get<std::string>();
    return reference.is_number_integer() ? reference.dump() : std::string();
  }

  std::vector<std::pair<std::string, const Json*>> items(const char* name) const {
    std::vector<std::pair<std::string, const Json*>> all;
    const auto found = json_.find(name);
    if (found == json_.end() || !found->is_structured()) return all;
    all.reserve(found->size());
    for (const auto& [key, value] : found->items()) all.emplace_back(key, &value);
    return all;
  }

  static std::vector<std::string> keysIn(const Json& from, const char* name) {
    std::vector<std::string> keys;
    const auto found = from.is_object() ? from.find(name) : from.end();
    if (!from.is_object() || found == from.end()) return keys;
    if (!found->is_array()) return {keyOf(*found)};
    keys.reserve(found->size());
    for (const Json& reference : *found) keys.push_back(keyOf(reference));
    return keys;
  }

  double countOf(const Json& primitive, const char* name) const {
    const auto accessors = json_.find("accessors");
    const auto found = primitive.is_object() ? primitive.find(name) : primitive.end();
    if (!primitive.is_object() || found == primitive.end() || accessors == json_.end()) return 0.0;
    const std::string key = keyOf(*found);
    const Json* accessor = nullptr;
    if (accessors->is_object()) {
      if (accessors->contains(key)) accessor = &accessors->at(key);
    } else if (accessors->is_array() && found->is_number_unsigned() &&
               found->get<std::size_t>() < accessors->size()) {
      accessor = &accessors->at(found->get<std::size_t>());
    }
    if (!accessor || !accessor->is_object() || !accessor->contains("count")) return 0.0;
    const Json& count = accessor->at("count");
    return count.is_number() ? std::max(count.get<double>(), 0.0) : 0.0;
  }

  /// Corners of all triangles, or vertices where those are more.
  double cornersOf(const Json& mesh) const {
    double corners = 0.0;
    const auto primitives = mesh.is_object() ? mesh.find("primitives") : mesh.end();
    if (!mesh.is_object() || primitives == mesh.end() || !primitives->is_array()) return corners;
    for (const Json& primitive : *primitives) {
      double vertices = 0.0;
      if (primitive.is_object() && primitive.contains("attributes")) {
        vertices = countOf(primitive.at("attributes"), "POSITION");
      }
      corners += std::max(vertices, countOf(primitive, "indices"));
    }
    return corners;
  }

  /// Adds up all below a node, deepest nodes first, without recursion.
  void sumUp(const std::string& root) {
    std::vector<Node*> path;
    const auto enter = [&](const std::string& key) {
      const auto found = nodes_.find(key);
      if (found == nodes_.end() || found->second.done) return;
      Node& node = found->second;
      if (node.entered) throw InputError(file_, "node " + shown(key) + " is below itself");
      node.entered = true;
      node.children = keysIn(*node.json, "children");
      for (const char* name : {"mesh", "meshes"}) {  // in 2.0, in 1.0
        for (const std::string& mesh : keysIn(*node.json, name)) {
          if (const auto of = corners_.find(mesh); of != corners_.end()) node.corners += of->second;
        }
      }
      path.push_back(&node);
      unvisited_.push_back(node.children.size());
    };
    enter(root);
    while (!path.empty()) {
      Node& node = *path.back();
      if (std::size_t& left = unvisited_.back(); left > 0) {
        enter(node.children[--left]);
        continue;
      }
      finish(node);
      path.pop_back();
      unvisited_.pop_back();
    }
  }

  void finish(Node& node) const {
    for (const std::string& key : node.children) {
      const auto child = nodes_.find(key);
      if (child == nodes_.end()) continue;
      node.instances += child->second.instances;
      node.corners += child->second.corners;
      node.height = std::max(node.height, child->second.height + 1);
    }
    node.done = true;
    refuseAbove(node.instances, kMaxInstances, "instances of nodes");
    refuseAbove(node.corners, kMaxCorners, "corners of triangles");
    if (node.height > kMaxNodeDepth) {
      throw InputError(file_, "its nodes nest " + std::to_string(node.height) +
                                  " deep: expected at most " + std::to_string(kMaxNodeDepth));
    }
  }

  std::string file_;
  const Json& json_;
  std::map<std::string, double> corners_;  // of each mesh
  std::map<std::string, Node> nodes_;
  std::vector<std::size_t> unvisited_;  // children of each node on the path
};

}  // namespace

std::optional<StatedTriangles> refuseHostileGltf(const GltfDocument& gltf) {
  SceneGraph graph(gltf);
  graph.refuseTooLarge();
  return graph.statedTriangles();
}

}  // namespace foci
