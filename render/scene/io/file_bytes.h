// Files as bytes, read with checked bounds, and the archives that they are packed in.
// Private to the readers of scenes.
#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <glm/glm.hpp>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/gunzip.h"
#include "base/mapped_file.h"

namespace foci {

/// The extension of a file in lower case, with its dot; of x.ply.gz ".ply".
std::string unpackedExtension(const std::filesystem::path& file);

/// A whole file, mapped into memory. Little endian.
class FileBytes {
 public:
  /// @param unpacks_gzip  the bytes are those that a gzip file holds
  /// @throws InputError if there is no readable regular file, or it cannot be unpacked
  explicit FileBytes(const std::filesystem::path& path, bool unpacks_gzip = false);
  /// Bytes that were unpacked from the file of this name.
  FileBytes(std::string name, std::vector<unsigned char> bytes)
      : name_(std::move(name)), unpacked_(std::move(bytes)), bytes_(unpacked_) {}
  FileBytes(const FileBytes&) = delete;
  FileBytes& operator=(const FileBytes&) = delete;

  const std::string& name() const { return name_; }
  std::size_t size() const { return bytes_.size(); }
  std::span<const unsigned char> all() const { return bytes_; }

  /// The part [at, at + count). @throws InputError if the file is shorter
  std::span<const unsigned char> part(std::uint64_t at, std::uint64_t count) const;

  /// Frees the memory of such a part, which can still be read.
  void release(std::uint64_t at, std::uint64_t count) const;

 private:
  std::string name_;
  std::unique_ptr<const MappedFile> file_;
  std::vector<unsigned char> unpacked_;
  std::span<const unsigned char> bytes_;
};

/// The first bytes of a file, at most `count`; fewer where the file is shorter or cannot be read.
std::vector<unsigned char> firstBytes(const std::filesystem::path& path, std::size_t count);

/// A value of `bytes`, which are at least as many (asserted).
template <typename T>
T valueAt(std::span<const unsigned char> bytes, std::size_t at) {
  assert(at + sizeof(T) <= bytes.size());
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}
inline constexpr auto& u16At = valueAt<std::uint16_t>;
inline constexpr auto& u32At = valueAt<std::uint32_t>;
inline constexpr auto& u64At = valueAt<std::uint64_t>;
inline constexpr auto& floatAt = valueAt<float>;
inline constexpr auto& doubleAt = valueAt<double>;
inline constexpr auto& vec3At = valueAt<glm::vec3>;
inline constexpr auto& dvec3At = valueAt<glm::dvec3>;

/// The members of a ZIP archive (PKWARE, APPNOTE 6.3): stored or deflated, without encryption and
/// without ZIP64.
class ZipArchive {
 public:
  /// Reads the directory. @param file  outlives it
  /// @throws InputError if there is no directory, or it is damaged
  explicit ZipArchive(const FileBytes& file);

  bool holds(const std::string& name) const { return members_.contains(name); }

  /// The unpacked member of this name.
  /// @throws InputError if there is none, it is damaged, or it is larger than `max_bytes`
  std::vector<unsigned char> read(const std::string& name, std::uint64_t max_bytes) const;

 private:
  struct Member {
    unsigned method = 0;
    std::uint32_t checksum = 0;
    std::uint64_t packed_bytes = 0, bytes = 0, header_at = 0;
  };

  const FileBytes& file_;
  std::map<std::string, Member> members_;
};

}  // namespace foci
