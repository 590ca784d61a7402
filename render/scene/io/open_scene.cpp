#include "render/scene/io/open_scene.h"

#include <algorithm>
#include <utility>

#include "base/input_error.h"
#include "base/text.h"
#include "render/lod/moment_tree.h"
#include "render/scene/estimation/estimate.h"
#include "render/scene/scene.h"

namespace foci {
namespace {

void scale(std::vector<glm::vec3>& lengths_m, float scale) {
  for (glm::vec3& length_m : lengths_m) length_m *= scale;
}

void scaleBy(SurfelCloud& cloud, float factor) {
  if (factor == 1.0f) return;
  for (auto* lengths_m : {&cloud.position_m, &cloud.axis_u_m, &cloud.axis_v_m}) {
    scale(lengths_m->own(), factor);
  }
  for (float& area_m2 : cloud.area_m2) area_m2 *= factor * factor;
  completeBodies(cloud);
}

/// In metres.
std::shared_ptr<const TriangleMesh> scaledMesh(MeshFile&& file, float factor) {
  const auto mesh = std::make_shared<TriangleMesh>(std::move(file.mesh));
  scale(mesh->corners_m, factor);
  return mesh;
}

}  // namespace

std::vector<std::string> droppedRemarks(std::size_t dropped, const std::string& what) {
  if (dropped == 0) return {};
  return {counted(dropped, what) +
          " left out: not finite, or farther than 1e9 units from the origin"};
}

OpenedPoints openPoints(SceneFile&& file, double scale_m, const MeshSampling& sampling) {
  const auto factor = static_cast<float>(scale_m);
  if (auto* const read = std::get_if<MeshFile>(&file.content)) {
    auto mesh = scaledMesh(std::move(*read), factor);
    return {sampleMesh(*mesh, file.path, sampling), mesh};
  }
  if (std::holds_alternative<GaussianFile>(file.content) ||
      std::holds_alternative<StreamedGaussians>(file.content)) {
    throw InputError(
        file.path.string(),
        "holds Gaussians, which are volumes: foci renders it as it is, without surfels");
  }
  auto* const points = std::get_if<PointCloud>(&file.content);
  if (points == nullptr) throw InputError(file.path.string(), "is a prepared scene already");
  scale(points->position_m, factor);
  for (float& radius_m : points->radius_m) radius_m *= factor;
  return {std::move(*points), nullptr};
}

OpenedScene openScene(SceneFile&& file, double scale_m, const std::optional<glm::vec3>& viewpoint_m,
                      const Fineness& fineness, std::optional<SurfelCloud> made) {
  const auto factor = static_cast<float>(scale_m);
  const auto surfelsAt = [&](PointCloud&& points) {
    return surfelsFromPoints(std::move(points), {.viewpoint_m = viewpoint_m});
  };
  if (const auto* const streamed = std::get_if<StreamedGaussians>(&file.content)) {
    const Fineness in_file = [&](const glm::vec3& low, const glm::vec3& high) {
      return fineness(factor * low, factor * high) / factor;
    };
    file.content = streamed->read(fineness ? in_file : Fineness{});
  }
  if (auto* const prepared = std::get_if<PreparedScene>(&file.content)) {
    if (scale_m != 1.0 && isLarge(prepared->scene)) {
      throw InputError(
          file.path.string(),
          "stays in its file, in metres, because it is large: expected scene.scale_m = 1");
    }
    std::visit([&](auto& cloud) { scaleBy(cloud, factor); }, prepared->scene.splats);
    return {std::move(prepared->scene)};
  }
  if (auto* const gaussians = std::get_if<GaussianFile>(&file.content)) {
    scaleBy(gaussians->cloud, factor);
    Scene scene{std::move(gaussians->cloud)};
    const auto add = [&](PointCloud&& points, const char* name) {
      scene = joined(std::move(scene), Scene{surfelsAt(std::move(points))}, name);
    };
    if (gaussians->mesh) {
      scale(gaussians->mesh->corners_m, factor);
      add(sampleMesh(*gaussians->mesh, file.path, {}), "mesh");
    }
    if (gaussians->points) {
      scale(gaussians->points->position_m, factor);
      add(std::move(*gaussians->points), "points");
    }
    std::vector<std::string> remarks = droppedRemarks(gaussians->dropped, "Gaussian");
    remarks.insert(remarks.end(), gaussians->remarks.begin(), gaussians->remarks.end());
    return {std::move(scene), std::move(remarks)};
  }
  if (auto* const read = std::get_if<MeshFile>(&file.content)) {
    const auto mesh = scaledMesh(std::move(*read), factor);
    SurfelCloud cloud = made ? std::move(*made) : surfelsAt(sampleMesh(*mesh, file.path, {}));
    cloud.mesh = mesh;
    return {{std::move(cloud)}, mesh->remarks};
  }
  PointCloud points = openPoints(std::move(file), scale_m).points;
  std::vector<std::string> remarks = droppedRemarks(points.dropped, "point");
  remarks.insert(remarks.end(), points.remarks.begin(), points.remarks.end());
  return {{made ? std::move(*made) : surfelsAt(std::move(points))}, std::move(remarks)};
}

}  // namespace foci
