// Names of files, and writing them so that no reader meets a half-written one; files of known size.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

namespace foci {

/// The extension of a name in lower case, with its dot.
std::string lowerExtension(const std::filesystem::path& path);

/// "cannot write PATH" and the reason, as far as its folder shows it: no right to write, or a full
/// disk. Of a folder: why nothing can be written to it.
std::string cannotWrite(const std::filesystem::path& path);

/// Replaces a file by `bytes`: writes a hidden file beside it, then renames that file. If anything
/// fails, the hidden file is removed and the old file stays as it was.
/// @throws std::runtime_error
void replaceFile(const std::filesystem::path& path, const std::string& bytes);

/// Writes `text` directly to a file. @throws std::runtime_error if not all of it could be written
void writeText(const std::filesystem::path& path, const std::string& text);

/// The user's folder for one kind of file, by the XDG Base Directory Specification.
/// @param variable  that names it, such as "XDG_CACHE_HOME"
/// @param in_home   where it is without that variable, such as ".cache"
/// @return none where the variable and HOME are not set
std::optional<std::filesystem::path> userFolder(const char* variable, const char* in_home);

/// @throws InputError if it is no regular file, cannot be read, or has more than `most` bytes
std::string bytesOfFile(const std::filesystem::path& file, std::uintmax_t most);

/// A new file of known size, written at any place by any number of threads.
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
