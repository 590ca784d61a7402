// The nodes and primitives of a glTF. Private to the readers of scenes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "render/scene/io/compression.h"
#include "render/scene/io/gltf_document.h"

namespace foci {

/// One of the places at which the scene shows a mesh.
struct GltfPlace {
  std::size_t node = 0, mesh = 0;
  std::optional<std::size_t> skin{};
  glm::dmat4 scene_from_mesh{1.0};  ///< of a mesh with a skin: the joints place it instead
  std::optional<glm::vec3> tint{};  ///< of an instance: times the colours of its vertices
  std::string name{};               ///< of the node, or the nearest name above it; may be empty
};

/// All places of the default scene, in the order of its nodes; the first scene if there is no
/// default, and all nodes without a scene. A node of EXT_mesh_gpu_instancing has several.
/// @param remarks  gets the number of hidden nodes
/// @throws InputError if nodes nest too deeply, a node is below itself, there are more than 2^18
/// instances, or all meshes are hidden
std::vector<GltfPlace> placesOf(const GltfDocument& gltf, std::vector<std::string>& remarks);

/// Where a node is in the scene, by all nodes above it.
class GltfNodes {
 public:
  explicit GltfNodes(const GltfDocument& gltf);

  std::size_t size() const { return parents_.size(); }
  bool isRoot(std::size_t node) const { return parents_[node] == kNoEntry; }
  glm::dmat4 sceneFrom(std::size_t node) const;

 private:
  const GltfDocument& gltf_;
  std::vector<std::size_t> parents_;
};

/// The mode of a primitive: 0 points, 1 to 3 lines, 4 triangles, 5 strip, 6 fan.
std::size_t modeOf(const GltfDocument& gltf, const nlohmann::json& primitive);

/// The numbers of a primitive, which may be compressed by Draco.
class GltfPrimitive {
 public:
  /// @param json  of the primitive; it and the document have to stay
  /// @throws InputError if it has no positions, or cannot be unpacked
  GltfPrimitive(const GltfDocument& gltf, const nlohmann::json& json);

  std::size_t vertices() const { return vertices_; }

  /// Numbers of an attribute by vertex; 0 if it has none.
  std::size_t componentsOf(const std::string& attribute) const;

  /// By vertex; empty if it has no such attribute.
  /// @throws InputError if there are not as many as positions, or they have other components
  std::vector<float> floats(const std::string& attribute, std::size_t components) const;

  /// The vertices in order, as the indices state them.
  std::vector<std::uint32_t> indices() const;

  /// Three vertices a triangle; empty for points and lines.
  std::vector<std::uint32_t> triangles() const;

 private:
  const GltfDocument& gltf_;
  const nlohmann::json& json_;
  std::size_t vertices_ = 0;
  std::optional<DracoPrimitive> draco_;
};

}  // namespace foci
