#include "render/scene/io/open_scene.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <utility>

#include "base/input_error.h"
#include "base/text.h"
#include "render/lod/moment_tree.h"
#include "render/scene/estimation/estimate.h"
#include "render/scene/io/file_bytes.h"
#include "render/scene/io/mesh_formats.h"
#include "render/scene/io/ply.h"
#include "render/scene/io/point_formats.h"
#include "render/scene/io/scan_values.h"

namespace foci {
namespace {

namespace fs = std::filesystem;

bool isObj(const FileStart& start) {
  constexpr std::array<std::string_view, 9> kWords = {"v", "vn", "vt", "mtllib", "usemtl",
                                                      "o", "g",  "s",  "vp"};
  return std::ranges::find(kWords, start.firstWord()) != kWords.end();
}

bool isStl(const FileStart& start) {
  if (start.text().starts_with("solid") && start.holdsAll({"facet"})) return true;
  constexpr std::size_t kHead = 84, kTriangle = 50;
  std::error_code ignored;
  const std::uintmax_t size = fs::file_size(start.path, ignored);
  return start.bytes.size() >= kHead + kTriangle && !ignored &&
         size == kHead + kTriangle * std::uintmax_t{u32At(start.bytes, kHead - 4)};
}

bool isGltfText(const FileStart& start) {
  return start.firstWord().starts_with('{') && !start.holdsAll({"\"geometricError\""}) &&
         (start.holdsAll({"\"asset\""}) || start.holdsAll({"\"accessors\""}) ||
          start.holdsAll({"\"bufferViews\""}));
}

bool isText(const FileStart& start) {
  return std::ranges::find(start.bytes, 0) == start.bytes.end();
}

template <auto kRead>
SceneContent with(const fs::path& path, std::uint64_t /*checked_B*/) {
  return kRead(path);
}

/// Of a reader of points or a mesh.
template <auto kRead>
SceneContent either(const fs::path& path, std::uint64_t /*checked_B*/) {
  return std::visit([](auto&& read) { return SceneContent(std::forward<decltype(read)>(read)); },
                    kRead(path));
}

SceneContent readPrepared(const fs::path& path, std::uint64_t checked_B) {
  if (isSceneFile(path)) return readSceneFile(path, checked_B);
  throw InputError(
      path.string(),
      "is no prepared scene: expected FOCI in its first bytes; foci prepare makes one");
}

SceneContent readPlyScene(const fs::path& path, std::uint64_t /*checked_B*/) {
  ply::Input input(path);
  const ply::Header header = ply::readHeader(input);
  if (isGaussianPly(header)) return readGaussianPly(path);
  if (isCompressedGaussianPly(header)) return readCompressedGaussianPly(path);
  if (isPlyMesh(header)) return readPlyMesh(path);
  return readPly(path);
}

/// Adds a remark if the mesh is far larger than the Gaussians beside it.
void remarkLargeMesh(GaussianFile& file) {
  constexpr float kOtherUnit = 30.0f;  // chosen by hand
  const auto extentOf = [](std::span<const glm::vec3> places) {
    const auto [low, high] = boxOf(places);
    return glm::length(high - low);
  };
  const float times = extentOf(file.mesh->corners_m) / extentOf(file.cloud.position_m);
  if (!(times > kOtherUnit)) return;
  file.remarks.push_back(
      "the mesh is " + thousands(double{times}) +
      " times as large as the Gaussians beside it: is one of them in another unit?");
}

/// Gaussians, with the mesh and the points beside them; else points, or a mesh.
SceneContent readGltfScene(const fs::path& path, std::uint64_t /*checked_B*/) {
  const GltfDocument gltf(path);
  GltfPoints found = readGltfPoints(gltf);
  if (!found.gaussians && (found.has_triangles || !found.points)) return readGltfMesh(gltf);
  if (!found.gaussians) return std::move(*found.points);
  GaussianFile& file = *found.gaussians;
  if (found.points) file.points = std::make_shared<PointCloud>(std::move(*found.points));
  if (found.has_triangles) {
    file.mesh = std::make_shared<TriangleMesh>(readGltfMesh(gltf, true).mesh);
    file.remarks.insert(file.remarks.end(), file.mesh->remarks.begin(), file.mesh->remarks.end());
    remarkLargeMesh(file);
  }
  return std::move(file);
}

SceneContent readSpzScene(const fs::path& path, std::uint64_t /*checked_B*/) {
  return readSpz(FileBytes(path));
}

using Kind = SceneKind;

/// Formats with a mark come first; in each half, the order decides.
constexpr std::array kSceneFormats = {
    SceneFormat{Kind::prepared, ".foci", true, false,
                [](const FileStart& s) { return isSceneFile(s.path); }, readPrepared},
    SceneFormat{Kind::las, ".las .laz", true, true,
                [](const FileStart& s) { return s.startsWith({"LASF"}); }, with<readLas>},
    SceneFormat{Kind::ply_points, ".ply", true, true,
                [](const FileStart& s) {
                  return s.startsWith({"ply\n", "ply\r", "ply "});
                },
                readPlyScene},
    SceneFormat{Kind::gaussians, ".ssog", true, false,
                [](const FileStart& s) { return isStreamedSog(s.path); },
                [](const fs::path& path, std::uint64_t) -> SceneContent {
                  return StreamedGaussians(path);
                }},
    SceneFormat{Kind::gaussians, ".sog", true, false,
                [](const FileStart& s) { return isSogFile(s.path); }, with<readSogFile>},
    SceneFormat{Kind::gltf, ".glb .gltf", true, false,
                [](const FileStart& s) { return s.startsWith({"glTF"}) || isGltfText(s); },
                readGltfScene},
    SceneFormat{Kind::fbx, ".fbx", true, false,
                [](const FileStart& s) {
                  return s.startsWith({"Kaydara FBX Binary", "; FBX"});
                },
                with<readFbxMesh>},
    SceneFormat{Kind::gaussians, ".spz", true, true,
                [](const FileStart& s) { return isSpz(s.bytes); }, readSpzScene},
    SceneFormat{Kind::gaussians, ".ksplat", true, false,
                [](const FileStart& s) { return isKsplatFile(s.path); }, with<readKsplatFile>},
    SceneFormat{Kind::pcd, ".pcd", true, true, [](const FileStart& s) { return isPcd(s.text()); },
                with<readPcd>},
    SceneFormat{Kind::obj, ".obj", false, false, isObj, either<readObj>},
    SceneFormat{Kind::stl, ".stl", false, false, isStl, with<readStlMesh>},
    SceneFormat{Kind::off_points, ".off", false, true,
                [](const FileStart& s) { return s.firstWord().ends_with("OFF"); }, either<readOff>},
    SceneFormat{Kind::gaussians, ".splat", false, false,
                [](const FileStart& s) { return isSplatFile(s.path); }, with<readSplatFile>},
    SceneFormat{Kind::colmap, "", false, false,
                [](const FileStart& s) { return isColmapFile(s.path); }, with<readColmap>},
    SceneFormat{Kind::text_points, ".xyz .pts .asc .pwn .xyzrgb", false, true,
                [](const FileStart& s) { return isText(s) && startsWithPoints(s.path); },
                with<readTextPoints>},
};

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

void scaleBy(PointCloud& points, float factor) {
  scale(points.position_m, factor);
  for (float& radius_m : points.radius_m) radius_m *= factor;
}

/// In metres.
std::shared_ptr<const TriangleMesh> scaledMesh(MeshFile&& file, float factor) {
  const auto mesh = std::make_shared<TriangleMesh>(std::move(file.mesh));
  scale(mesh->corners_m, factor);
  return mesh;
}

}  // namespace

const SceneFormat* formatOf(const FileStart& start) {
  const auto find = [](const auto& condition) {
    const auto* const found = std::ranges::find_if(kSceneFormats, condition);
    return found == kSceneFormats.end() ? nullptr : found;
  };
  const SceneFormat* format =
      find([&](const SceneFormat& each) { return each.marked && each.begins(start); });
  if (format == nullptr) {
    format = find([&](const SceneFormat& each) { return start.hasExtensionIn(each.extensions); });
  }
  if (format != nullptr || start.hasOtherFormat()) return format;
  return find([&](const SceneFormat& each) { return !each.marked && each.begins(start); });
}

fs::path sceneFileIn(const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_directory(path, ignored)) return path;
  for (const char* name : {"lod-meta.json", "meta.json", "points3D.bin", "points3D.txt",
                           "sparse/0/points3D.bin", "sparse/0/points3D.txt"}) {
    if (fs::is_regular_file(path / name, ignored)) return path / name;
  }
  return path;
}

bool isScene(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) return true;  // refused, with the reason
  const FileStart start(path);
  const SceneFormat* const format = formatOf(start);
  return format != nullptr || refusalOf(start, format).has_value();
}

SceneFile readScene(const fs::path& given, std::uint64_t checked_B) {
  std::error_code ignored;
  const fs::path path = sceneFileIn(given);
  if (!fs::exists(path, ignored)) throw InputError(path.string(), "no such file");
  if (fs::is_directory(path, ignored)) {
    throw InputError(path.string(), "is a folder, not a file: give the scene in it");
  }
  requireRegularFile(path);
  const FileStart start(path);
  const SceneFormat* const format = formatOf(start);
  if (const auto refusal = refusalOf(start, format)) throw InputError(path.string(), *refusal);
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
  if (auto* const points = std::get_if<PointCloud>(&file.content)) {
    scaleBy(*points, factor);
    return {std::move(*points), nullptr};
  }
  throw InputError(
      file.path.string(),
      std::holds_alternative<PreparedScene>(file.content)
          ? "is a prepared scene already"
          : "holds Gaussians, which are volumes: foci renders it as it is, without surfels");
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
  auto& points = std::get<PointCloud>(file.content);
  scaleBy(points, factor);
  std::vector<std::string> remarks = droppedRemarks(points.dropped, "point");
  remarks.insert(remarks.end(), points.remarks.begin(), points.remarks.end());
  return {{made ? std::move(*made) : surfelsAt(std::move(points))}, std::move(remarks)};
}

}  // namespace foci
