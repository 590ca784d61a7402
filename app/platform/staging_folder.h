// A hidden folder in an output folder, in which a run writes its files until they get their final
// names. It also tells other runs, in other containers and on other machines too, what this run
// writes there:
//
//   .foci-0123456789abcdef/   a random token, so that no two runs share a folder
//     lock                    who writes; locked while the run lives, and touched as a heartbeat
//     claims/NAME             the final names
//     all                     is there if the run claims the whole folder
//     new/NAME                files before their renames
//     old/NAME                second names of the files that they replace
//
// A run is dead if nobody holds the lock and the lock is from this start of this machine, or if the
// heartbeat is older than a minute. The next run in the folder removes what a dead one left.
#pragma once

#include <filesystem>
#include <string>

namespace foci {

class StagingFolder {
 public:
  /// @param folder  exists
  /// @throws std::runtime_error if it cannot be made
  explicit StagingFolder(std::filesystem::path folder);
  /// Removes it, and all that is left in it.
  ~StagingFolder();
  StagingFolder& operator=(StagingFolder&&) = delete;  // nor copied

  /// Reserves a name, until the staging folder is removed.
  /// @throws InputError naming the run that has it; std::runtime_error
  void claim(const std::string& name);
  /// Reserves the folder against other runs that claim all of it.
  void claimAll();

  std::filesystem::path newFile(const std::string& name) const { return staging_ / "new" / name; }
  std::filesystem::path oldFile(const std::string& name) const { return staging_ / "old" / name; }

  /// The heartbeat.
  void touch() const noexcept;

 private:
  void make(const std::filesystem::path& claim, const std::filesystem::path& place) const;
  void requireAlone(const std::filesystem::path& claim, const std::filesystem::path& place) const;

  std::filesystem::path folder_, staging_;
  int lock_ = -1;
  bool all_ = false;
};

/// A lock on a folder between runs, where its file system has locks.
class FolderLock {
 public:
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(FolderLock&& other) noexcept;
  FolderLock& operator=(FolderLock&&) = delete;  // nor copied

 private:
  int file_ = -1;
};

}  // namespace foci
