// The surfels of meshes and scans that were opened before, in the user's cache folder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>

#include "render/scene/io/open_scene.h"

namespace foci {

/// Keeps surfels with their tree as prepared scenes (foci_file.h). The name of an entry is the hash
/// of all that the surfels depend on: the triangles, materials and textures of the mesh, or the
/// points, in metres, and this program. Entries are written aside and renamed, so that runs at the
/// same time see whole ones. A damaged entry is made again. Whatever fails, a scene opens without.
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

  /// The surfels made from `source`, with their tree: those of an entry, or new ones.
  SurfelCloud surfelsOf(const SurfelSource& source, const std::function<SurfelCloud()>& make) const;

  struct Content {
    std::size_t entries = 0;
    std::uint64_t bytes = 0;
  };
  Content content() const;

 private:
  void keep(const std::filesystem::path& entry, const SurfelCloud& cloud) const;
  /// Deletes entries until `bytes` more fit in.
  void makeRoom(std::uint64_t bytes) const;

  std::filesystem::path folder_;
  Limits limits_;
};

}  // namespace foci
