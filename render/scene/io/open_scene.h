// Opens a scene file of any supported format as surfels or Gaussians. foci decides by the table of
// formats (open_scene.cpp) alone whether a file is a scene, and which reader takes it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "render/scene/io/foci_file.h"
#include "render/scene/io/gaussian_formats.h"
#include "render/scene/io/scene_facts.h"
#include "render/scene/mesh/sample_mesh.h"
#include "render/scene/point_cloud.h"
#include "render/scene/scene.h"

namespace foci {

using SceneContent =
    std::variant<PointCloud, MeshFile, PreparedScene, GaussianFile, StreamedGaussians>;

/// The beginning of a file, which shows its format.
struct FileStart {
  /// Of a file that is not there, or is no regular file: its name only.
  explicit FileStart(const std::filesystem::path& file);

  std::filesystem::path path;
  std::string extension;             ///< in lower case, with its dot; of x.ply.gz ".ply"
  std::vector<unsigned char> bytes;  ///< the first ones, unpacked if the file is gzip
  bool gzip = false;

  std::string_view text() const {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  /// Blanks before the text do not count.
  bool startsWith(std::initializer_list<std::string_view> any) const;
  bool holdsAll(std::initializer_list<std::string_view> all) const;
  /// Of the first line that is neither empty nor a comment.
  std::string_view firstWord() const;
  /// @param extensions  ".las .laz"
  bool hasExtensionIn(std::string_view extensions) const;
  /// Whether its extension is that of a format that foci does not read.
  bool hasOtherFormat() const;
};

struct SceneFormat {
  SceneKind kind;               ///< of its points; meshes and Gaussians state their own
  std::string_view extensions;  ///< ".las .laz"
  bool marked;                  ///< its first bytes are a mark of its own, whatever the name is
  bool gzip;                    ///< its reader unpacks gzip
  bool (*begins)(const FileStart& start);
  SceneContent (*read)(const std::filesystem::path& path, std::uint64_t checked_B);
};

/// The format of a file: the one whose mark it has, or else that of its extension, or else the one
/// that its content suggests. Null if there is none.
const SceneFormat* formatOf(const FileStart& start);

/// Why a file is no scene, although it may look like one: a pointer of Git LFS, an archive, a
/// picture, a format that foci does not read. Absent if foci may read it, or knows nothing of it.
/// @param format  `formatOf(start)`
std::optional<std::string> refusalOf(const FileStart& start, const SceneFormat* format);

/// Of a folder that is a scene, the file that describes it; other paths stay.
std::filesystem::path sceneFileIn(const std::filesystem::path& path);

/// Whether a file is a scene and not a study: foci reads it, or knows why not (`refusalOf`).
bool isScene(const std::filesystem::path& path);

/// A scene file as read: in its own units, a mesh not sampled, no surfels estimated.
struct SceneFile {
  std::filesystem::path path;
  SceneContent content;
  SceneKind kind = SceneKind::ply_points;  ///< of points
};

/// Reads a scene of any format in the table.
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

/// The surfels or Gaussians of a scene file.
/// @param scale_m      metres a unit of the file, > 0
/// @param viewpoint_m  estimated normals point towards this place
/// @param fineness     of a streamed scene, in metres: see `StreamedGaussians::read`
/// @param made         the surfels of the mesh or of the points, if they were made before
/// @throws InputError naming the file and what is wrong with it
OpenedScene openScene(SceneFile&& file, double scale_m, const std::optional<glm::vec3>& viewpoint_m,
                      const Fineness& fineness = {}, std::optional<SurfelCloud> made = {});

/// Reads and opens it. @throws InputError as `readScene` and the above
inline OpenedScene openScene(const std::filesystem::path& path, double scale_m,
                             const std::optional<glm::vec3>& viewpoint_m) {
  return openScene(readScene(path), scale_m, viewpoint_m);
}

}  // namespace foci
