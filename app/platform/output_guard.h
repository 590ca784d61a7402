// What a command may write: the one guard of all outputs. It holds before the command reads
// anything, and again at the moment of each rename.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "app/platform/staging_folder.h"

namespace foci {

/// Where a folder is, or will be once it is made: absolute, without links and `..`. A `..` after a
/// folder that does not exist yet leads to the folder above it.
std::filesystem::path folderPlace(const std::filesystem::path& folder);

/// The place of a file: that of its folder, and its name. A link in the file's place is not
/// followed, since a rename replaces the link.
std::filesystem::path filePlace(const std::filesystem::path& file);

/// Refuses a folder that cannot be made because it, or a folder above it, is a file.
/// @param folder  may not exist yet
/// @throws InputError
void requireFolderOrNothing(const std::filesystem::path& folder);

class OutputGuard {
 public:
  /// Without inputs; replaces only files that foci made.
  OutputGuard() = default;

  /// Refuses an output that is also an input. Device and inode tell, so links count, too. Refuses
  /// two outputs in one file, folders, pipes, devices, and names that are too long. Without
  /// `overwrite`, refuses to replace a file that foci did not make.
  /// @param outputs, inputs  empty paths are options that were not given
  /// @throws InputError
  OutputGuard(const std::vector<std::filesystem::path>& outputs,
              const std::vector<std::filesystem::path>& inputs, bool overwrite);

  /// The same for one output as its place is now.
  /// @param place  `filePlace` of the output
  /// @param ours   the file there, if there is one, is as foci left it
  /// @throws InputError
  void check(const std::filesystem::path& output, const std::filesystem::path& place,
             bool ours) const;

 private:
  std::map<std::string, std::filesystem::path> inputs_;  ///< by identity, and by place
  bool overwrite_ = false;
};

/// The files that earlier runs left as they are now. Reads the list of each folder once.
class WrittenFiles {
 public:
  /// @throws InputError if the folder's list is not one of foci's
  bool has(const std::filesystem::path& file);

 private:
  std::map<std::filesystem::path, std::set<std::string>> lists_;
};

/// The list of one folder, locked against other runs while it lives.
/// The files of a folder that foci wrote, listed in the hidden file `.foci-outputs` beside them. A
/// file counts as written by foci while its size and its time of modification are those that foci
/// left: a file that somebody edits later is somebody's own.
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
