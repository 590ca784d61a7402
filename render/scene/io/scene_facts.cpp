#include "render/scene/io/scene_facts.h"

#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <variant>

#include "render/lod/moment_tree.h"
#include "render/scene/gaussian_cloud.h"
#include "render/scene/io/open_scene.h"

namespace foci {

namespace {

bool differ(std::span<const glm::vec3> colors) {
  return std::ranges::adjacent_find(colors, std::not_equal_to()) != colors.end();
}

glm::vec2 rangeOf(std::span<const float> opacity) {
  if (opacity.empty()) return glm::vec2(1.0f);
  const auto [least, greatest] = std::ranges::minmax_element(opacity);
  return {*least, *greatest};
}

SceneFacts factsOfGaussians(const GaussianCloud& cloud) {
  std::vector<glm::vec3> reach;
  reach.reserve(cloud.size());
  for (const Covariance3& v : cloud.covariance_m2) {
    reach.push_back(glm::sqrt(glm::max(glm::vec3(v.xx, v.yy, v.zz), 0.0f)));
  }
  return {.kind = SceneKind::gaussians,
          .gaussians = cloud.size(),
          .has_colors = true,
          .opacity = rangeOf(cloud.opacity),
          .harmonics_degree = cloud.degree,
          .position = cloud.position_m,
          .reach = std::move(reach)};
}

SceneFacts factsOfPrepared(const GaussianCloud& cloud, const SurfelOrigin& origin) {
  SceneFacts facts = factsOfGaussians(cloud);
  facts.y_is_down = origin.y_is_down;
  return facts;
}

SceneFacts factsOfPrepared(const SurfelCloud& cloud, const SurfelOrigin& origin) {
  return {.kind = SceneKind::prepared,
          .surfels = cloud.size(),
          .has_normals = cloud.oriented,
          .has_colors = !origin.plain_colors,
          .material_colors = origin.plain_colors && differ(cloud.color),
          .opacity = rangeOf(cloud.opacity),
          .samples_of_mesh = origin.mesh,
          .up_axis = origin.up_axis,
          .y_is_down = origin.y_is_down,
          .position = {cloud.position_m.begin(), cloud.position_m.end()}};
}

SceneFacts factsOfContent(const PreparedScene& file) {
  const std::optional<Scene> outline = outlineOf(file.scene);
  SceneFacts facts =
      std::visit([&](const auto& cloud) { return factsOfPrepared(cloud, file.origin); },
                 (outline ? *outline : file.scene).splats);
  if (outline) facts.surfels = file.scene.size();
  facts.large = outline.has_value();
  facts.unit_m = 1.0;
  return facts;
}

SceneFacts factsOfContent(const MeshFile& file) {
  SceneFacts facts = file.facts;
  facts.position = file.mesh.corners_m;
  facts.remarks = file.mesh.remarks;
  return facts;
}

SceneFacts factsOfContent(const PointCloud& points) {
  return {.format = points.format,
          .points = points.size(),
          .has_normals = !points.normal.empty(),
          .has_colors = differ(points.color),
          .opacity = rangeOf(points.opacity),
          .dropped = points.dropped,
          .remarks = points.remarks,
          .unit_m = points.unit_m,
          .up_axis = points.up_axis,
          .y_is_down = points.y_is_down,
          .position = points.position_m};
}

SceneFacts factsOfContent(const StreamedGaussians& scene) {
  return {.kind = SceneKind::gaussians,
          .format = "3D Gaussians (streamed SOG)",
          .gaussians = scene.size(),
          .has_colors = true,
          .y_is_down = true,
          .position = scene.corners()};
}

SceneFacts factsOfContent(const GaussianFile& file) {
  SceneFacts facts = factsOfGaussians(file.cloud);
  facts.format = "3D Gaussians (" + file.format + ")";
  facts.unit_m = file.unit_m;
  if (file.mesh) {
    const std::vector<glm::vec3>& corners = file.mesh->corners_m;
    facts.triangles = file.mesh->size();
    facts.position.insert(facts.position.end(), corners.begin(), corners.end());
  }
  if (file.points) {
    const std::vector<glm::vec3>& positions = file.points->position_m;
    facts.points = positions.size();
    facts.position.insert(facts.position.end(), positions.begin(), positions.end());
  }
  facts.reach.resize(facts.position.size(), glm::vec3(0.0f));
  facts.dropped = file.dropped;
  facts.remarks = file.remarks;
  facts.y_is_down = !file.y_is_up;
  return facts;
}

}  // namespace

std::string nameOf(const SceneFacts& facts) {
  if (!facts.format.empty()) return facts.format;
  constexpr std::array kNames = {// in the order of SceneKind
                                 "glTF mesh",      "OBJ mesh",      "STL mesh",   "FBX mesh",
                                 "PLY mesh",       "OFF mesh",      "OFF points", "PLY points",
                                 "LAS scan",       "COLMAP points", "PCD points", "points as text",
                                 "prepared scene", "3D Gaussians"};
  static_assert(kNames.size() == static_cast<std::size_t>(SceneKind::gaussians) + 1);
  return kNames[static_cast<std::size_t>(facts.kind)];
}

std::string whatStatesUnit(const SceneFacts& facts) {
  if (facts.kind != SceneKind::gaussians) return nameOf(facts);
  return facts.format.empty() ? "prepared scene" : "glTF";
}

SceneFacts factsOf(const SceneFile& file) {
  SceneFacts facts =
      std::visit([](const auto& content) { return factsOfContent(content); }, file.content);
  if (std::holds_alternative<PointCloud>(file.content)) facts.kind = file.kind;
  return facts;
}

}  // namespace foci
