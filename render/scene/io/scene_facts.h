// What a scene file holds, before foci renders it: counts, materials, units, places of its points.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

namespace foci {

struct TextureFacts {
  std::string name;  ///< as the file names it
  bool found = true;
};

struct MaterialFacts {
  std::string name;
  std::vector<TextureFacts> textures;  ///< of its colour
  float opacity = 1.0f;
};

/// The kinds of files that differ in what is usual for them.
enum class SceneKind {
  gltf,
  obj,
  stl,
  fbx,
  ply_mesh,
  off_mesh,
  off_points,
  ply_points,
  las,
  colmap,
  pcd,
  text_points,
  prepared,
  gaussians
};

struct SceneFacts {
  SceneKind kind = SceneKind::ply_points;
  std::string format{};  ///< a name that says more than the kind's
  std::size_t points = 0, triangles = 0, surfels = 0, gaussians = 0;
  std::vector<MaterialFacts> materials{};
  bool has_normals = false;
  bool has_colors = false;             ///< of points or vertices, or textures: they differ
  bool material_colors = false;        ///< no such colours, but materials that differ in theirs
  glm::vec2 opacity{1.0f};             ///< least and greatest
  std::size_t dropped = 0;             ///< points whose position is not finite
  std::vector<std::string> remarks{};  ///< see `PointCloud`
  bool samples_of_mesh = false;        ///< a prepared scene that was a mesh

  /// Metres a unit, if the format or the file says so; up axis (0 x, 1 y, 2 z), if the file does.
  std::optional<double> unit_m{};
  std::optional<int> up_axis{};
  bool y_is_down = false;    ///< the convention of cameras, which captured scenes share
  int harmonics_degree = 0;  ///< of Gaussians
  bool large = false;        ///< stays in its file, in metres: `position` is its outline's

  /// Where the scene is, units of the file: its points, its surfels, or the corners of its
  /// triangles. Not empty.
  std::vector<glm::vec3> position{};
  /// How far each Gaussian reaches from its position along the axes: a standard deviation. Empty
  /// for others.
  std::vector<glm::vec3> reach{};

  bool isMesh() const { return triangles > 0; }
};

/// "glTF mesh", "LAS scan", "3D Gaussians (SPZ)", ...
std::string nameOf(const SceneFacts& facts);

/// What states `unit_m`: Gaussians have a unit in a glTF or a prepared scene only.
std::string whatStatesUnit(const SceneFacts& facts);

struct SceneFile;

SceneFacts factsOf(const SceneFile& file);

}  // namespace foci
