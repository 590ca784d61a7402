// A file in memory without a copy: pages are read when they are first used.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

namespace foci {

class MappedFile {
 public:
  /// @throws InputError if it is no regular file or cannot be read
  explicit MappedFile(const std::filesystem::path& path);
  ~MappedFile();
  MappedFile& operator=(MappedFile&&) = delete;  // nor copied

  std::span<const unsigned char> bytes() const {
    return {static_cast<const unsigned char*>(at_), size_};
  }
  const std::string& name() const { return name_; }

 private:
  std::string name_;
  void* at_ = nullptr;
  std::size_t size_ = 0;
};

/// Frees the memory of a part of a mapped file, which can still be read.
void releasePages(std::span<const unsigned char> bytes);

/// Asks the system to read a part of a mapped file ahead. Does not wait.
void readAhead(std::span<const unsigned char> bytes);

/// From now on, a mapped file that shrinks, or cannot be read, ends the program with one line on
/// standard error and the exit code 1. Otherwise the program ends by the signal SIGBUS when it
/// touches a page that is gone. Any other cause of that signal ends the program as usual.
void endOnLostPages();

/// The same for a library: changes nothing if the program, or another of its libraries, handles
/// SIGBUS itself.
void endOnLostPagesUnlessHandled();

}  // namespace foci
