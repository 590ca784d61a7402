// A new file of known size, written at any place by any number of threads.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

namespace foci {

class SizedFile {
 public:
  /// Replaces what is there. @throws std::runtime_error
  SizedFile(const std::filesystem::path& path, std::uint64_t bytes);
  ~SizedFile();
  SizedFile& operator=(SizedFile&&) = delete;  // nor copied

  /// @throws std::runtime_error
  void put(std::uint64_t at, std::span<const unsigned char> bytes);

 private:
  std::filesystem::path path_;
  int file_;
};

}  // namespace foci
