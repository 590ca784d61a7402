// Opens a scene file of any supported format as surfels.
#pragma once

#include <cstddef>
#include <filesystem>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "render/scene/mesh/sample_mesh.h"
#include "render/scene/point_cloud.h"
#include "render/scene/surfel_cloud.h"

namespace foci {

/// Whether a file is a scene and not a study: by its first bytes, by its extension, or by the
/// points in its text. The extensions of formats that `openPoints` refuses count.
bool isScene(const std::filesystem::path& path);

struct OpenedPoints {
  PointCloud points;
  std::shared_ptr<const TriangleMesh> mesh;  ///< null: the file has points only
};

/// Reads the points of a scan (PLY, LAS, text), or samples those of a mesh.
/// @param scale_m  metres a unit of the file, > 0
/// @throws InputError, see `readPly`, `readLas`, `readTextPoints`, `readMesh` and `sampleMesh`. For
///         a format that foci does not read, it names a converter.
OpenedPoints openPoints(const std::filesystem::path& path, double scale_m,
                        const MeshSampling& sampling = {});

struct OpenedScene {
  SurfelCloud cloud;                      ///< not empty
  std::size_t dropped = 0;                ///< points dropped because their position was not finite
  std::vector<std::string> remarks = {};  ///< see `PointCloud`
};

/// Opens a `.foci` scene or a LAS scan (recognised by their first bytes), a mesh (OBJ, glTF, STL,
/// FBX, PLY with faces), points as text, or, for any other file, a PLY point cloud.
/// @param scale_m      metres a unit of the file, > 0
/// @param viewpoint_m  estimated normals point towards this place
/// @throws InputError naming the file and what is wrong with it
OpenedScene openScene(const std::filesystem::path& path, double scale_m,
                      const std::optional<glm::vec3>& viewpoint_m);

}  // namespace foci
