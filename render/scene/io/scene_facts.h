// What a scene file holds, before foci renders it: counts, materials, units, places of its points;
// and triangle meshes as files hold them.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "render/scene/mesh/triangle_mesh.h"

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

/// All triangles of a mesh file, in its units, with the nodes' transforms applied. Triangles are
/// turned to the side of the file's own normals if it has some. Vertex colours are sRGB, but linear
/// in glTF. Alpha cuts holes or makes surfaces transparent, as glTF states; in other files, a
/// texture's alpha below 0.5 is a hole, and so is the mask of an OBJ.
///
/// A texture that cannot be read, or has more than 2^26 pixels, and a file of materials that cannot
/// be read are named in the mesh's remarks. The material's colour then shows.
struct MeshFile {
  TriangleMesh mesh;
  SceneFacts facts;  ///< but the positions and the remarks, which the mesh has
};

}  // namespace foci
