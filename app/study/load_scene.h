// Loads the scene of a study. Surfels of meshes and scans that were opened before lie in the user's
// cache folder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/platform/warnings.h"
#include "app/study/study.h"
#include "render/lod/moment_tree.h"
#include "render/optics/view.h"
#include "render/scene/io/open_scene.h"
#include "render/scene/scene.h"

namespace foci {

/// In the order of its tree, which all methods and the gaze's distance share. Warns of what a user
/// should know of the files, and of the place of the eye (`viewRemarks`).
/// @param file  the study's scene file, if it has been read
/// @throws InputError
Scene loadScene(const Study& study, Warnings& warnings, std::optional<SceneFile> file = {});

/// Keeps surfels with their tree as prepared scenes (foci_file.h). The name of an entry is the hash
/// of all that the surfels depend on: the triangles, materials and textures of the mesh, or the
/// points, their scale, and this program. Entries are written aside and renamed, so that runs at
/// the same time see whole ones. A damaged entry is made again. Whatever fails, a scene opens
/// without.
class SceneCache {
 public:
  struct Limits {
    std::uint64_t max_B = std::uint64_t{4} << 30;  ///< the entries used longest ago go first
    std::size_t min_surfels = 100'000;             ///< fewer are made as fast as they are found
  };

  SceneCache(std::filesystem::path folder, const Limits& limits);
  explicit SceneCache(std::filesystem::path folder) : SceneCache(std::move(folder), Limits{}) {}

  /// `foci/scenes` in $XDG_CACHE_HOME, else in ~/.cache; absent if neither is set.
  static std::optional<std::filesystem::path> userFolder();

  /// The entry of the surfels that `openScene` makes; absent if it makes none, or too few.
  std::optional<std::filesystem::path> entryOf(const SceneFile& file, double scale_m,
                                               const std::optional<glm::vec3>& viewpoint_m) const;

  /// The surfels of an entry, with their tree; absent if they have to be made.
  std::optional<SurfelCloud> find(const std::filesystem::path& entry) const;

  /// @param scene  surfels with their tree
  void keep(const std::filesystem::path& entry, const Scene& scene) const;

  struct Content {
    std::size_t entries = 0;
    std::uint64_t bytes = 0;
  };
  Content content() const;

 private:
  /// Deletes entries until `bytes` more fit in.
  void makeRoom(std::uint64_t bytes) const;

  std::filesystem::path folder_;
  Limits limits_;
};

/// A scene wider than this, or narrower, is remarked on: farther away than 100 m the optics of an
/// eye hardly tell distances apart, and an eye focuses on nothing nearer than some centimetres.
inline constexpr double kWidestScene_m = 1000.0, kNarrowestScene_m = 0.001;

/// What an eye in the study's first pose sees.
View firstViewOf(const Study& study);

/// Whether any surfel may reach into the image that an eye in the study's first pose sees.
bool isSceneInView(const Study& study, const Scene& scene);

/// One sentence for each fault, with the key to set; empty for an ordinary view. Looks at the eye's
/// pose at the beginning, or the scene's own pose. The eye stands inside a solid if it sees the
/// backs of oriented surfels in nearly all directions, or any surfels nearer than 2 cm.
std::vector<std::string> viewRemarks(const Study& study, const Scene& scene);

/// How much memory the study's method takes, and which methods take less; empty for a scene that is
/// not large, and for a method with level of detail.
std::string memoryRemark(const Study& study, const Scene& scene, std::size_t large = kLargeScene);

}  // namespace foci
