#include "render/scene/io/open_scene.h"

#include <utility>

#include "base/input_error.h"
#include "render/scene/estimation/estimate.h"
#include "render/scene/io/foci_file.h"
#include "render/scene/io/ply.h"

namespace foci {

PointCloud openPoints(const std::filesystem::path& path, double scale_m,
                      const MeshSampling& sampling) {
  requireRegularFile(path);
  PointCloud points = isMeshFile(path) ? sampleMesh(path, sampling) : readPly(path);
  const auto scale = static_cast<float>(scale_m);
  for (glm::vec3& position_m : points.position_m) position_m *= scale;
  for (float& radius_m : points.radius_m) radius_m *= scale;
  return points;
}

OpenedScene openScene(const std::filesystem::path& path, double scale_m,
                      const std::optional<glm::vec3>& viewpoint_m) {
  requireRegularFile(path);
  if (isSceneFile(path)) {
    SurfelCloud cloud = readSceneFile(path);
    const auto scale = static_cast<float>(scale_m);
    for (auto* lengths_m : {&cloud.position_m, &cloud.axis_u_m, &cloud.axis_v_m}) {
      for (glm::vec3& length_m : *lengths_m) length_m *= scale;
    }
    for (float& area_m2 : cloud.area_m2) area_m2 *= scale * scale;
    return {std::move(cloud), 0};
  }
  PointCloud points = openPoints(path, scale_m);
  const std::size_t dropped = points.dropped;
  return {surfelsFromPoints(std::move(points), {.viewpoint_m = viewpoint_m}), dropped};
}

}  // namespace foci
