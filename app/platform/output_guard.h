// What a command may write: the one guard of all outputs. It holds before the command reads
// anything, and again at the moment of each rename.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

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
  /// `overwrite`, refuses to replace a file that foci did not make (output_ledger.h).
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

}  // namespace foci
