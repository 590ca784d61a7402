// Files for the tests of readers.
#pragma once

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "base/input_error.h"

namespace foci {

/// A temporary file with the given bytes. The destructor removes it.
class ScratchFile {
 public:
  explicit ScratchFile(std::string_view bytes) {
    static int count = 0;
    path_ = std::filesystem::temp_directory_path() /
            ("foci_" + std::to_string(getpid()) + "_" + std::to_string(++count));
    std::ofstream(path_, std::ios::binary) << bytes;
  }
  ~ScratchFile() { std::filesystem::remove(path_); }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// What a reader says of a file that it refuses.
template <typename Read>
std::string refusalBy(const Read& read) {
  try {
    read();
  } catch (const InputError& error) {
    return error.what();
  }
  return "not refused";
}

/// Folder of the real recordings. It may be absent.
inline std::filesystem::path gazeData() {
  const char* folder = std::getenv("FOCI_DATA");
  return std::filesystem::path(folder ? folder : FOCI_SOURCE_DIR "/../shared/data") / "gaze";
}

}  // namespace foci
