#include "render/scene/io/open_scene.h"

#include <algorithm>
#include <utility>

#include "base/input_error.h"
#include "base/text.h"
#include "render/lod/moment_tree.h"
#include "render/scene/estimation/estimate.h"
#include "render/scene/io/scan_values.h"

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

/// Whether a point's normal has to be estimated.
bool lacksNormals(const PointCloud& points) {
  return points.normal.empty() ||
         std::ranges::find(points.normal, glm::vec3(0.0f)) != points.normal.end();
}

}  // namespace

std::vector<std::string> droppedRemarks(std::size_t dropped, const std::string& what) {
  if (dropped == 0) return {};
  return {counted(dropped, what) +
          " left out: not finite, or farther than 1e9 units from the origin"};
}

bool isScene(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) return true;  // refused, with the reason
  const FileStart start(path);
  return formatOf(start) != nullptr || refusalOf(start).has_value();
}

SceneFile readScene(const std::filesystem::path& given, std::uint64_t checked_B) {
  std::error_code ignored;
  const std::filesystem::path path = sceneFileIn(given);
  if (!std::filesystem::exists(path, ignored)) throw InputError(path.string(), "no such file");
  if (std::filesystem::is_directory(path, ignored)) {
    throw InputError(path.string(), "is a folder, not a file: give the scene in it");
  }
  requireRegularFile(path);
  const FileStart start(path);
  if (const auto refusal = refusalOf(start)) throw InputError(path.string(), *refusal);
  const SceneFormat* const format = formatOf(start);
  if (format == nullptr) {
    throw InputError(path.string(),
                     start.bytes.empty()
                         ? "is empty"
                         : "is no scene that foci reads (docs/scenes.md lists the formats and "
                           "their extensions); points as text begin with numbers, or with a line "
                           "of names that has x, y and z");
  }
  SceneFile file{path, format->read(path, checked_B), format->kind};
  if (auto* const points = std::get_if<PointCloud>(&file.content)) remarkDegrees(*points);
  return file;
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
                      const Fineness& fineness, const SurfelStore& store) {
  const auto surfelsAt = [&](PointCloud&& points) {
    return surfelsFromPoints(std::move(points), {.viewpoint_m = viewpoint_m});
  };
  if (const auto* const streamed = std::get_if<StreamedGaussians>(&file.content)) {
    const auto unit_m = static_cast<float>(scale_m);
    const Fineness in_file = [&](const glm::vec3& low, const glm::vec3& high) {
      return fineness(unit_m * low, unit_m * high) / unit_m;
    };
    file.content = streamed->read(fineness ? in_file : Fineness{});
  }
  const auto factor = static_cast<float>(scale_m);
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
  const auto surfelsOf = [&](const SurfelSource& source, const std::function<SurfelCloud()>& make) {
    return store ? store(source, make) : make();
  };
  if (auto* const read = std::get_if<MeshFile>(&file.content)) {
    auto mesh = scaledMesh(std::move(*read), factor);
    SurfelCloud cloud = surfelsOf({.mesh = mesh.get()},
                                  [&] { return surfelsAt(sampleMesh(*mesh, file.path, {})); });
    std::vector<std::string> remarks = mesh->remarks;
    cloud.mesh = std::move(mesh);
    return {{std::move(cloud)}, std::move(remarks)};
  }
  PointCloud points = openPoints(std::move(file), scale_m).points;
  std::vector<std::string> remarks = droppedRemarks(points.dropped, "point");
  remarks.insert(remarks.end(), points.remarks.begin(), points.remarks.end());
  const SurfelSource source{.points = &points,
                            .viewpoint_m = lacksNormals(points) ? viewpoint_m : std::nullopt};
  SurfelCloud cloud = surfelsOf(source, [&] { return surfelsAt(std::move(points)); });
  return {{std::move(cloud)}, std::move(remarks)};
}

}  // namespace foci
