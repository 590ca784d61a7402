// Opens a scene file of any supported format as surfels.
#pragma once

#include <cstddef>
#include <filesystem>
#include <glm/glm.hpp>
#include <optional>

#include "render/scene/io/mesh.h"
#include "render/scene/surfel_cloud.h"

namespace foci {

/// Reads the points of a PLY file, or samples those of a mesh.
/// @param scale_m  metres a unit of the file, > 0
/// @throws InputError, see `readPly` and `sampleMesh`
PointCloud openPoints(const std::filesystem::path& path, double scale_m,
                      const MeshSampling& sampling = {});

struct OpenedScene {
  SurfelCloud cloud;        ///< not empty
  std::size_t dropped = 0;  ///< points dropped because their position was not finite
};

/// Opens a `.foci` scene (recognised by its first bytes), a mesh (OBJ, glTF, STL, PLY with faces)
/// or, for any other file, a PLY point cloud.
/// @param scale_m      metres a unit of the file, > 0
/// @param viewpoint_m  estimated normals point towards this place
/// @throws InputError naming the file and what is wrong with it
OpenedScene openScene(const std::filesystem::path& path, double scale_m,
                      const std::optional<glm::vec3>& viewpoint_m);

}  // namespace foci
