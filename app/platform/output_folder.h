// A folder of outputs (output_files.h). A run that fails leaves nothing, not even the folder.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "app/platform/output_files.h"

namespace foci {

class OutputFolder {
 public:
  /// Makes the folder and its missing parents.
  /// @throws std::runtime_error if a folder cannot be made, or nothing can be written to it
  explicit OutputFolder(std::filesystem::path folder);

  /// The temporary path of `name`, with the same extension. Also removes temporary files of `name`
  /// that killed runs left.
  std::filesystem::path stage(const std::string& name);

  /// Stages a file with this content. @throws std::runtime_error
  void write(const std::string& name, const std::string& bytes);

  /// Stages a file that `write_to` writes. @throws std::runtime_error
  void write(const std::string& name,
             const std::function<void(const std::filesystem::path&)>& write_to);

  /// Gives every staged file its final name, or none.
  /// @throws std::runtime_error
  void commit();

 private:
  std::filesystem::path folder_;
  OutputFiles files_;
};

}  // namespace foci
