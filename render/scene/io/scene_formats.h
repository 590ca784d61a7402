// The table of scene formats: extensions, first bytes and readers. foci decides by this table alone
// whether a file is a scene, and which reader takes it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "render/scene/io/foci_file.h"
#include "render/scene/io/gaussian_formats.h"
#include "render/scene/io/scene_facts.h"
#include "render/scene/point_cloud.h"

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
std::optional<std::string> refusalOf(const FileStart& start);

/// Of a folder that is a scene, the file that describes it; other paths stay.
std::filesystem::path sceneFileIn(const std::filesystem::path& path);

}  // namespace foci
