// A folder of outputs (output_files.h). A run that fails leaves nothing, not even the folder.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "app/platform/output_files.h"

namespace foci {

class OutputFolder {
 public:
  /// Makes the folder and its missing parents, and claims it.
  /// @throws InputError if another run writes there; std::runtime_error if a folder cannot be made,
  /// or nothing can be written to it
  OutputFolder(std::filesystem::path folder, const OutputGuard& guard);

  /// The temporary path of `name`, with the same name.
  std::filesystem::path stage(const std::string& name);

  /// Stages a file with this content. @throws std::runtime_error
  void write(const std::string& name, const std::string& bytes);

  /// Stages a file that `write_to` writes. @throws std::runtime_error
  void write(const std::string& name,
             const std::function<void(const std::filesystem::path&)>& write_to);

  /// For files elsewhere that appear together with those of the folder.
  OutputFiles& files() { return files_; }

  /// Gives every staged file its final name, or none.
  /// @throws InputError, std::runtime_error
  void commit();

 private:
  std::filesystem::path folder_;
  OutputFiles files_;
};

}  // namespace foci
