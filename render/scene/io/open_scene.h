// Any file that holds a scene, as surfels.
#pragma once

#include <cstddef>
#include <filesystem>
#include <glm/glm.hpp>
#include <optional>

#include "render/scene/io/mesh.h"
#include "render/scene/surfel_cloud.h"

namespace foci {

/// Points of a PLY file as they are, or of a mesh as sampled.
/// @param scale_m  metres a unit of the file, > 0
/// @throws InputError as `readPly` and `sampleMesh` do
PointCloud openPoints(const std::filesystem::path& path, double scale_m,
                      const MeshSampling& sampling = {});

struct OpenedScene {
  SurfelCloud cloud;        ///< not empty
  std::size_t dropped = 0;  ///< points left out since their position was not finite
};

/// Opens a `.foci` scene (told by its first bytes), a mesh (OBJ, glTF, STL, PLY with faces) or a
/// PLY point cloud (anything else).
/// @param scale_m      metres a unit of the file, > 0
/// @param viewpoint_m  estimated normals are turned towards it
/// @throws InputError naming the file and what is wrong with it
OpenedScene openScene(const std::filesystem::path& path, double scale_m,
                      const std::optional<glm::vec3>& viewpoint_m);

}  // namespace foci
