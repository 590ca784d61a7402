// Loads the scene of a study. Surfels of meshes and scans that were opened before lie in the user's
// cache folder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>

#include "app/platform/warnings.h"
#include "app/study/study.h"
#include "render/scene/io/open_scene.h"

namespace foci {

/// In the order of its tree, which all methods and the gaze's distance share. Warns of what a user
/// should know of the files, and of the place of the eye (view_remarks.h).
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

}  // namespace foci
