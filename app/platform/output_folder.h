// A folder of outputs. Files get temporary names first and their final names together: readers
// never meet half a file, and a run that fails leaves nothing.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace foci {

/// Files have hidden temporary names until `commit`. Without `commit`, the destructor removes them,
/// and the folders that the constructor made.
class OutputFolder {
 public:
  /// Makes the folder and its missing parents.
  /// @throws std::runtime_error if a folder cannot be made
  explicit OutputFolder(std::filesystem::path folder);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// The temporary path of `name`, with the same extension. Also removes temporary files of `name`
  /// that killed runs left.
  std::filesystem::path stage(const std::string& name);

  /// Gives every staged file its final name, in the order of staging.
  /// @throws std::runtime_error
  void commit();

 private:
  struct Staged {
    std::filesystem::path temporary, final;
  };
  std::filesystem::path folder_;
  std::vector<std::filesystem::path> made_;  ///< outermost first
  std::vector<Staged> staged_;
  bool committed_ = false;
};

}  // namespace foci
