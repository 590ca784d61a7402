#include "render/scene/io/scene_facts.h"

#include <algorithm>
#include <utility>

#include "base/input_error.h"
#include "render/scene/io/foci_file.h"
#include "render/scene/io/las.h"
#include "render/scene/io/mesh.h"
#include "render/scene/io/open_scene.h"
#include "render/scene/io/text_points.h"

namespace foci {
namespace {

bool differ(const std::vector<glm::vec3>& colors) {
  return std::any_of(colors.begin(), colors.end(),
                     [&](const glm::vec3& color) { return color != colors.front(); });
}

glm::vec2 rangeOf(const std::vector<float>& opacity) {
  if (opacity.empty()) return glm::vec2(1.0f);
  const auto [least, greatest] = std::minmax_element(opacity.begin(), opacity.end());
  return {*least, *greatest};
}

SceneFacts factsOfPrepared(const std::filesystem::path& path) {
  SurfelCloud cloud = readSceneFile(path);
  SceneFacts facts{.kind = SceneKind::prepared,
                   .surfels = cloud.size(),
                   .has_normals = cloud.oriented,
                   .has_colors = differ(cloud.color),
                   .opacity = rangeOf(cloud.opacity),
                   .unit_m = 1.0};
  facts.position = std::move(cloud.position_m);
  return facts;
}

SceneFacts factsOfPoints(const std::filesystem::path& path) {
  PointCloud points = openPoints(path, 1.0).points;
  SceneFacts facts{.points = points.size(),
                   .has_normals = !points.normal.empty(),
                   .has_colors = differ(points.color),
                   .opacity = rangeOf(points.opacity),
                   .dropped = points.dropped,
                   .remarks = std::move(points.remarks)};
  if (isLasFile(path)) {
    facts.kind = SceneKind::las;
    facts.unit_m = 1.0;  // as nearly all surveys
    facts.up_axis = 2;
  } else if (isTextPointsFile(path)) {
    facts.kind = SceneKind::text_points;
  }
  facts.position = std::move(points.position_m);
  return facts;
}

}  // namespace

std::string nameOf(SceneKind kind) {
  switch (kind) {
    case SceneKind::gltf:
      return "glTF mesh";
    case SceneKind::obj:
      return "OBJ mesh";
    case SceneKind::stl:
      return "STL mesh";
    case SceneKind::fbx:
      return "FBX mesh";
    case SceneKind::ply_mesh:
      return "PLY mesh";
    case SceneKind::ply_points:
      return "PLY points";
    case SceneKind::las:
      return "LAS scan";
    case SceneKind::text_points:
      return "points as text";
    case SceneKind::prepared:
      return "prepared scene";
  }
  return "";
}

SceneFacts readSceneFacts(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) throw InputError(path.string(), "no such file");
  requireRegularFile(path);
  if (isSceneFile(path)) return factsOfPrepared(path);
  if (!isLasFile(path) && isMeshFile(path)) return readMeshFacts(path);
  return factsOfPoints(path);
}

}  // namespace foci
