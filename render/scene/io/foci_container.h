// The container of `.foci` files: a header with checksums, then arrays. foci_file.h has the layout.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "base/file.h"
#include "base/input_error.h"
#include "base/mapped_file.h"

namespace foci {

/// Versions by content. Programs before the first version wrote 1 and 3: surfels without a tree.
inline constexpr std::uint32_t kFociGaussians = 2, kFociTree = 4;

inline constexpr std::array<unsigned char, 8> kFociMagic = {'F',  'O',  'C',  'I',
                                                            '\r', '\n', 0x1a, '\n'};

struct FociHeader {
  std::array<unsigned char, 8> magic = kFociMagic;
  std::uint32_t version = kFociTree;
  std::uint32_t flags = 0;
  std::uint64_t count = 0;  ///< surfels or Gaussians
  std::uint64_t file_bytes = 0;
  std::uint64_t content_checksum = 0;
  std::array<std::uint64_t, 2> more{};  ///< of kFociTree; else 0
  std::uint64_t header_checksum = 0;
};
static_assert(sizeof(FociHeader) == 64);

/// Whether readers compare checksums. Fuzzers, which cannot guess them, turn it off.
inline bool compare_foci_checksums = true;

using ByteSpan = std::span<const unsigned char>;

/// @param values  contiguous
template <typename Values>
ByteSpan bytesOf(const Values& values) {
  return {reinterpret_cast<const unsigned char*>(values.data()),
          values.size() * sizeof(typename Values::value_type)};
}

/// The bytes of an array with the zeros up to a multiple of `align`.
inline std::uint64_t aligned(std::uint64_t bytes, std::uint64_t align) {
  return (bytes + align - 1) / align * align;
}

/// Writes a file array by array, and each array in any number of pieces.
class FociWriter {
 public:
  /// @param sizes  bytes of each array
  /// @param align  each array begins at a multiple of it, and so does the end of the file
  /// @throws std::runtime_error, as all functions here
  FociWriter(const std::filesystem::path& path, const FociHeader& header,
             const std::vector<std::uint64_t>& sizes, std::uint64_t align = 1);

  /// @param at  first byte within the array
  void write(std::size_t array, std::uint64_t at, ByteSpan bytes);

  /// Reads the file back for the checksums, and writes the header.
  void finish();

 private:
  std::filesystem::path path_;
  FociHeader header_;
  std::vector<std::uint64_t> begin_;  // of each array, and the end of the file
  std::optional<SizedFile> file_{};
};

/// The same at once.
void writeFoci(const std::filesystem::path& path, const FociHeader& header,
               const std::vector<ByteSpan>& arrays);

/// The content of a mapped scene is checked up to this size as it is opened. For a larger one it
/// would take as long as reading all of the file.
inline constexpr std::uint64_t kCheckedFile_B = std::uint64_t{1} << 30;
inline constexpr std::uint64_t kCheckAll_B = std::numeric_limits<std::uint64_t>::max();

/// A file, mapped for reading. Its header is sound.
class FociContainer {
 public:
  /// @throws InputError
  explicit FociContainer(const std::filesystem::path& path,
                         std::uint64_t checked_B = kCheckedFile_B);

  const FociHeader& header() const { return header_; }

  /// Whether `arrays` checks the content.
  bool isChecked() const { return checked_; }

  /// @throws InputError  always, with the file's name
  template <typename... Parts>
  [[noreturn]] void refuse(const Parts&... why) const {
    throw InputError(file_.name(), why...);
  }

  /// The arrays of these numbers of bytes. @throws InputError if they are not the whole content, or
  /// it was altered
  std::vector<ByteSpan> arrays(const std::vector<std::uint64_t>& bytes,
                               std::uint64_t align = 1) const;

 private:
  void readHeader();

  MappedFile file_;
  bool checked_;
  FociHeader header_;
};

}  // namespace foci
