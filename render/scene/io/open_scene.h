// Opens a scene file of any supported format as surfels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "render/scene/io/scene_formats.h"
#include "render/scene/mesh/sample_mesh.h"
#include "render/scene/scene.h"

namespace foci {

/// Whether a file is a scene and not a study: foci reads it, or knows why not (scene_formats.h).
bool isScene(const std::filesystem::path& path);

/// A scene file as read: in its own units, a mesh not sampled, no surfels estimated.
struct SceneFile {
  std::filesystem::path path;
  SceneContent content;
  SceneKind kind = SceneKind::ply_points;  ///< of points
};

/// Reads a scene of any format in the table of scene_formats.h.
/// @throws InputError as the format's reader does. For a file that is no scene, it says what the
///         file is, and names a converter.
/// @param checked_B  see `readSceneFile`
SceneFile readScene(const std::filesystem::path& path, std::uint64_t checked_B = kCheckedFile_B);

struct OpenedPoints {
  PointCloud points;
  std::shared_ptr<const TriangleMesh> mesh;  ///< null: the file has points only
};

/// The points of a scan, or samples of a mesh.
/// @param scale_m  metres a unit of the file, > 0
/// @throws InputError, see `sampleMesh`; for a prepared scene, and for Gaussians
OpenedPoints openPoints(SceneFile&& file, double scale_m, const MeshSampling& sampling = {});

struct OpenedScene {
  Scene scene;                            ///< not empty
  std::vector<std::string> remarks = {};  ///< see `PointCloud`, and what was left out
};

/// Says how many points or Gaussians, as `what` names one, were left out of a file; nothing of 0.
std::vector<std::string> droppedRemarks(std::size_t dropped, const std::string& what);

/// All that the surfels of a mesh or of points depend on, in metres.
struct SurfelSource {
  const TriangleMesh* mesh = nullptr;  ///< or
  const PointCloud* points = nullptr;
  std::optional<glm::vec3> viewpoint_m = {};  ///< if normals have to be estimated
};

/// Takes surfels that were made before, or has them made.
using SurfelStore = std::function<SurfelCloud(const SurfelSource& source,
                                              const std::function<SurfelCloud()>& make)>;

/// The surfels or Gaussians of a scene file.
/// @param scale_m      metres a unit of the file, > 0
/// @param viewpoint_m  estimated normals point towards this place
/// @param fineness     of a streamed scene, in metres: see `StreamedGaussians::read`
/// @param store        of the surfels of a mesh or of points; none: they are made
/// @throws InputError naming the file and what is wrong with it
OpenedScene openScene(SceneFile&& file, double scale_m, const std::optional<glm::vec3>& viewpoint_m,
                      const Fineness& fineness = {}, const SurfelStore& store = {});

/// Reads and opens it. @throws InputError as `readScene` and the above
inline OpenedScene openScene(const std::filesystem::path& path, double scale_m,
                             const std::optional<glm::vec3>& viewpoint_m) {
  return openScene(readScene(path), scale_m, viewpoint_m);
}

}  // namespace foci
