#include "render/scene/io/open_scene.h"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>

#include "base/file.h"
#include "base/input_error.h"
#include "render/lod/outline.h"
#include "render/scene/estimation/estimate.h"
#include "render/scene/io/foci_file.h"
#include "render/scene/io/gaussian_formats.h"
#include "render/scene/io/las.h"
#include "render/scene/io/mesh.h"
#include "render/scene/io/off.h"
#include "render/scene/io/ply.h"
#include "render/scene/io/scan_values.h"
#include "render/scene/io/text_points.h"

namespace foci {
namespace {

constexpr std::string_view kPdal = "CloudCompare, or pdal translate IN OUT.ply, makes a PLY of it";
constexpr std::string_view kBlender = "Blender can export it as glTF";
constexpr std::string_view kCad = "FreeCAD can export it as STL or OBJ";
constexpr std::string_view kParaview = "ParaView can export it as PLY";
constexpr std::string_view kSplats = "SuperSplat or splat-transform makes a PLY of it";

/// Formats that foci does not read, and what converts them.
struct Converter {
  std::string_view extension, how;
};
constexpr std::array kConverters = {
    Converter{".e57", kPdal},     Converter{".pcd", kPdal},     Converter{".ptx", kPdal},
    Converter{".dae", kBlender},  Converter{".3ds", kBlender},  Converter{".blend", kBlender},
    Converter{".usd", kBlender},  Converter{".usdc", kBlender}, Converter{".usdz", kBlender},
    Converter{".x3d", kBlender},  Converter{".wrl", kBlender},  Converter{".lwo", kBlender},
    Converter{".dxf", kBlender},  Converter{".3mf", kCad},      Converter{".step", kCad},
    Converter{".stp", kCad},      Converter{".iges", kCad},     Converter{".igs", kCad},
    Converter{".vtk", kParaview}, Converter{".vtp", kParaview}, Converter{".vtu", kParaview},
    Converter{".lcc", kSplats},   Converter{".usda", kBlender}, Converter{".abc", kBlender},
    Converter{".3dm", kCad},      Converter{".amf", kCad},      Converter{".drc", kBlender},
};

/// @throws InputError for a format that is known and not read
void refuseUnread(const std::filesystem::path& path) {
  const std::string extension = lowerExtension(path);
  const auto* found =
      std::find_if(kConverters.begin(), kConverters.end(),
                   [&](const Converter& each) { return each.extension == extension; });
  if (found == kConverters.end()) return;
  throw InputError(path.string(), "foci does not read " + extension.substr(1) +
                                      " files: " + std::string(found->how));
}

bool hasSceneExtension(const std::filesystem::path& path) {
  static constexpr std::array<std::string_view, 18> kRead = {
      ".foci", ".ply", ".obj", ".gltf", ".glb", ".stl", ".fbx",   ".las",    ".laz",
      ".xyz",  ".pts", ".asc", ".off",  ".pwn", ".spz", ".splat", ".ksplat", ".sog"};
  const std::string extension = lowerExtension(path);
  return std::find(kRead.begin(), kRead.end(), extension) != kRead.end() ||
         std::any_of(kConverters.begin(), kConverters.end(),
                     [&](const Converter& each) { return each.extension == extension; });
}

PointCloud readPoints(const std::filesystem::path& path) {
  if (isLasFile(path)) return readLas(path);
  if (isTextPointsFile(path)) return readTextPoints(path);
  refuseUnread(path);
  if (const std::string extension = lowerExtension(path);
      extension == ".csv" || extension == ".txt") {
    throw InputError(path.string(),
                     "is no scene: points as text begin with numbers, or with a line of names that "
                     "has x, y and z");
  }
  return readPly(path);
}

PointCloud pointsOf(const std::filesystem::path& path) {
  PointCloud points = readPoints(path);
  remarkDegrees(points);
  return points;
}

void scale(std::vector<glm::vec3>& lengths_m, float scale) {
  for (glm::vec3& length_m : lengths_m) length_m *= scale;
}

SurfelCloud scaled(SurfelCloud&& cloud, float factor) {
  if (factor == 1.0f) return std::move(cloud);
  for (auto* lengths_m : {&cloud.position_m, &cloud.axis_u_m, &cloud.axis_v_m}) {
    scale(lengths_m->own(), factor);
  }
  for (float& area_m2 : cloud.area_m2) area_m2 *= factor * factor;
  cloud.tree.reset();
  completeBodies(cloud);
  if (cloud.gaussians) {
    const auto gaussians = std::make_shared<GaussianCloud>(*cloud.gaussians);
    scaleBy(*gaussians, factor);
    cloud.gaussians = gaussians;
  }
  return std::move(cloud);
}

}  // namespace

bool isScene(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return hasSceneExtension(path);
  return hasSceneExtension(path) || isSceneFile(path) || isLasFile(path) ||
         isTextPointsFile(path) || isSpzFile(path) || isSogFile(path);
}

SceneFile readScene(const std::filesystem::path& path, std::uint64_t checked_B) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) throw InputError(path.string(), "no such file");
  requireRegularFile(path);
  if (isSceneFile(path)) return {path, readSceneFile(path, checked_B)};
  if (lowerExtension(path) == ".foci") {
    throw InputError(path.string(),
                     "is no prepared scene: expected FOCI in its first bytes; foci prepare makes "
                     "one");
  }
  if (isOffFile(path)) {
    return std::visit([&](auto read) { return SceneFile{path, std::move(read)}; }, readOff(path));
  }
  if (!isLasFile(path) && !isTextPointsFile(path)) {
    if (auto gaussians = readGaussians(path)) return {path, std::move(*gaussians)};
  }
  if (!isLasFile(path) && isMeshFile(path)) return {path, readMesh(path)};
  return {path, pointsOf(path)};
}

OpenedPoints openPoints(SceneFile&& file, double scale_m, const MeshSampling& sampling) {
  const auto factor = static_cast<float>(scale_m);
  if (auto* const read = std::get_if<MeshFile>(&file.content)) {
    const auto mesh = std::make_shared<TriangleMesh>(std::move(read->mesh));
    scale(mesh->corners_m, factor);
    return {sampleMesh(*mesh, file.path, sampling), mesh};
  }
  if (std::holds_alternative<GaussianFile>(file.content)) {
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

OpenedScene openScene(SceneFile&& file, double scale_m,
                      const std::optional<glm::vec3>& viewpoint_m) {
  if (auto* const prepared = std::get_if<PreparedScene>(&file.content)) {
    if (scale_m != 1.0 && prepared->cloud.tree && prepared->cloud.size() > kLargeScene) {
      throw InputError(file.path.string(),
                       "stays in its file, in metres, because it is large: "
                       "expected scene.scale_m = 1");
    }
    return {scaled(std::move(prepared->cloud), static_cast<float>(scale_m))};
  }
  if (auto* const gaussians = std::get_if<GaussianFile>(&file.content)) {
    scaleBy(gaussians->cloud, static_cast<float>(scale_m));
    SurfelCloud cloud;
    cloud.gaussians = std::make_shared<GaussianCloud>(std::move(gaussians->cloud));
    return {std::move(cloud), gaussians->dropped, std::move(gaussians->remarks)};
  }
  OpenedPoints opened = openPoints(std::move(file), scale_m);
  const std::size_t dropped = opened.points.dropped;
  std::vector<std::string> remarks = std::move(opened.points.remarks);
  SurfelCloud cloud = surfelsFromPoints(std::move(opened.points), {.viewpoint_m = viewpoint_m});
  cloud.mesh = std::move(opened.mesh);
  return {std::move(cloud), dropped, std::move(remarks)};
}

}  // namespace foci
