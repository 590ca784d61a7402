// The files that a command writes. All of them appear together, or none does.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace foci {

/// Refuses a folder that cannot be made because it, or a folder above it, is a file.
/// @param folder  may not exist yet
/// @throws InputError
void requireFolderOrNothing(const std::filesystem::path& folder);

/// Refuses outputs that a command must not write. Call it before the command reads anything. It
/// refuses an output that is also an input. Device and inode tell, so links count, too. It refuses
/// two outputs in one file, folders, pipes, devices, and names that are too long. Without
/// `overwrite`, it refuses to replace a file that foci did not make (output_ledger.h).
/// @param outputs, inputs  empty paths are options that were not given
/// @throws InputError
void checkOutputs(const std::vector<std::filesystem::path>& outputs,
                  const std::vector<std::filesystem::path>& inputs, bool overwrite);

/// Files have hidden temporary names until `commit`. Without `commit`, the destructor removes them,
/// and the folders that were made for them.
class OutputFiles {
 public:
  OutputFiles() = default;
  ~OutputFiles();
  OutputFiles(const OutputFiles&) = delete;
  OutputFiles& operator=(const OutputFiles&) = delete;

  /// Makes a folder and its missing parents.
  /// @throws std::runtime_error if it cannot be made, or nothing can be written to it
  void makeFolder(const std::filesystem::path& folder);

  /// The temporary path of `file`, with the same extension. Makes its folder, and removes temporary
  /// files of `file` that killed runs left.
  /// @throws std::runtime_error
  std::filesystem::path stage(const std::filesystem::path& file);

  /// Stages a file that `write_to` writes. @throws std::runtime_error naming `file`
  void write(const std::filesystem::path& file,
             const std::function<void(const std::filesystem::path&)>& write_to);

  /// Stages a file with this content. @throws std::runtime_error
  void write(const std::filesystem::path& file, const std::string& bytes);

  /// Gives every staged file its final name, in the order of staging. If one cannot have it, all
  /// names lead to their old files again.
  /// @throws std::runtime_error
  void commit();

 private:
  struct Staged {
    std::filesystem::path temporary, final;
    std::filesystem::path old{};  ///< a second name of the file to be replaced, if there is one
    bool placed = false, replaced = false;
  };
  /// Removes the temporary files of killed runs: files whose name holds the id of a process that no
  /// longer exists.
  void removeLeftovers(const std::filesystem::path& folder, const std::string& before,
                       const std::string& after);
  void place(Staged& file);
  void undo() noexcept;

  std::vector<std::filesystem::path> made_;  ///< folders, each after its parents
  std::vector<Staged> staged_;
  /// Hidden files of each folder before anything was staged there: a folder of many images is
  /// listed once.
  std::map<std::filesystem::path, std::vector<std::string>> hidden_;
  bool committed_ = false;
};

}  // namespace foci
