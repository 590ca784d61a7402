// A file, plain or in gzip format (RFC 1952), byte by byte.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>

namespace foci {

class PackedFile {
 public:
  /// @throws InputError if it cannot be read
  explicit PackedFile(const std::filesystem::path& file);
  ~PackedFile();
  PackedFile(const PackedFile&) = delete;
  PackedFile& operator=(const PackedFile&) = delete;

  /// @return the number of bytes read, at most `count`; 0 at the end
  /// @throws InputError if a packed file is damaged or cut off, also in a later member, and if it
  /// unpacks to far more than a recording does
  std::size_t read(char* to, std::size_t count);

 private:
  struct State;  // zlib's
  std::unique_ptr<State> state_;
};

}  // namespace foci
