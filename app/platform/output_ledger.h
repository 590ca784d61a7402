// The files of a folder that foci wrote, listed in the hidden file `.foci-outputs` beside them. A
// file counts as written by foci while its size and its time of modification are those that foci
// left: a file that somebody edits later is somebody's own.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "app/platform/staging_folder.h"

namespace foci {

/// The files that earlier runs left as they are now. Reads the list of each folder once.
class WrittenFiles {
 public:
  /// @throws InputError if the folder's list is not one of foci's
  bool has(const std::filesystem::path& file);

 private:
  std::map<std::filesystem::path, std::set<std::string>> lists_;
};

/// The list of one folder, locked against other runs while it lives.
class OutputLedger {
 public:
  /// Files that are gone or have changed leave the list.
  /// @throws InputError if the list is not one of foci's
  explicit OutputLedger(const std::filesystem::path& folder);

  /// The file is as foci left it.
  bool has(const std::filesystem::path& file) const;

  /// Lists a file that is about to be renamed to `name` in the folder.
  void add(const std::filesystem::path& temporary, const std::string& name);

  /// Writes the list. Call it before the renames: after a kill between them, the next run still
  /// knows the files.
  /// @throws std::runtime_error
  void save();

  /// Removes the list if it is new: the run has failed.
  void giveUp() noexcept;

 private:
  std::filesystem::path folder_;
  FolderLock lock_;
  std::vector<std::string> lines_;
  bool is_new_ = false;
};

}  // namespace foci
