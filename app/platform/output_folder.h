// Outputs are written aside and renamed together: a reader never meets a half-written file, and a
// run that fails leaves nothing.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace foci {

/// The folder of a run's files. Until `commit`, they stand aside under hidden names; if it is never
/// reached, they are removed, and so are the folders that were made for them.
class OutputFolder {
 public:
  /// Makes the folder and its parents where they are missing.
  /// @throws std::runtime_error where that fails, or where the path is something else
  explicit OutputFolder(std::filesystem::path folder);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Where to write `name` for now; same extension, same file system. What a killed run has left
  /// there of the same name is removed.
  std::filesystem::path stage(const std::string& name);

  /// Gives every staged file its name, in the order of staging.
  /// @throws std::runtime_error
  void commit();

 private:
  struct Staged {
    std::filesystem::path aside, final;
  };
  std::filesystem::path folder_;
  std::vector<std::filesystem::path> made_;  ///< outermost first
  std::vector<Staged> staged_;
  bool committed_ = false;
};

}  // namespace foci
