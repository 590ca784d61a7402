// The files that a command writes. All of them appear together, or none does.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "app/platform/output_guard.h"
#include "app/platform/staging_folder.h"

namespace foci {

/// Files stand in staging folders (staging_folder.h) until `commit`. Without `commit`, the
/// destructor removes them, and the folders that were made for them. Each file goes to its place as
/// it is when the file is staged (`filePlace`). Objects may be used in several threads, each in
/// one.
class OutputFiles {
 public:
  explicit OutputFiles(OutputGuard guard);
  ~OutputFiles();
  OutputFiles& operator=(OutputFiles&&) = delete;  // nor copied

  /// Makes a folder and its missing parents.
  /// @throws std::runtime_error if it cannot be made, or nothing can be written to it
  void makeFolder(const std::filesystem::path& folder);

  /// Makes a folder, and keeps other runs that claim it out of it.
  /// @throws InputError naming such a run; std::runtime_error
  void claimFolder(const std::filesystem::path& folder);

  /// The temporary path of `file`, with the same name. Makes its folder, and removes what killed
  /// runs left there.
  /// @throws InputError if another run writes this file; std::runtime_error
  std::filesystem::path stage(const std::filesystem::path& file);

  /// Stages a file that `write_to` writes. @throws std::runtime_error naming `file`
  void write(const std::filesystem::path& file,
             const std::function<void(const std::filesystem::path&)>& write_to);

  /// Stages a file with this content. @throws std::runtime_error
  void write(const std::filesystem::path& file, const std::string& bytes);

  /// Gives every staged file its final name, in the order of staging. If one cannot have it, or the
  /// guard refuses it, all names lead to their old files again.
  /// @throws InputError, std::runtime_error
  void commit();

 private:
  friend void touchUnfinishedOutputs();
  friend void removeUnfinishedOutputs();
  struct Staged {
    std::filesystem::path output;  ///< as named
    std::filesystem::path temporary, final;
    std::filesystem::path old{};  ///< a second name of the file to be replaced, if there is one
    bool placed = false, replaced = false;
  };
  /// @param place  of the folder, which exists
  StagingFolder& stagingIn(const std::filesystem::path& place);
  std::filesystem::path makePlace(const std::filesystem::path& folder);
  void place(Staged& file, const OutputLedger& ledger);
  void undo() noexcept;
  void abandon() noexcept;

  OutputGuard guard_;
  std::vector<std::filesystem::path> made_;  ///< folders, each after its parents
  std::map<std::filesystem::path, StagingFolder> stagings_;
  std::vector<Staged> staged_;
};

/// Writes one file and commits it. @throws InputError, std::runtime_error
void writeOutput(const std::filesystem::path& file, const std::string& bytes,
                 const OutputGuard& guard);

/// The heartbeat of all files that are not committed.
void touchUnfinishedOutputs();

/// Removes all files that are not committed, for a process that is about to end: whoever calls any
/// function of `OutputFiles` afterwards waits for ever.
void removeUnfinishedOutputs();

/// A folder of outputs. A run that fails leaves nothing, not even the folder.
class OutputFolder {
 public:
  /// Makes the folder and its missing parents, and claims it.
  /// @throws InputError if another run writes there; std::runtime_error if a folder cannot be made,
  /// or nothing can be written to it
  OutputFolder(std::filesystem::path folder, const OutputGuard& guard);

  /// The temporary path of `name`, with the same name.
  std::filesystem::path stage(const std::string& name) { return files_.stage(folder_ / name); }

  /// Stages a file with these bytes, or that a function writes. @throws std::runtime_error
  template <class Content>
  void write(const std::string& name, const Content& content) {
    files_.write(folder_ / name, content);
  }

  /// For files elsewhere that appear together with those of the folder.
  OutputFiles& files() { return files_; }

  /// Gives every staged file its final name, or none.
  /// @throws InputError, std::runtime_error
  void commit() { files_.commit(); }

 private:
  std::filesystem::path folder_;
  OutputFiles files_;
};

}  // namespace foci
