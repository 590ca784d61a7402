// The container of `.foci` files: a header with checksums, then arrays without gaps. foci_file.h
// has the layout.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace foci {

/// Versions by content; kFociMore are surfels with closed bodies or objects.
inline constexpr std::uint32_t kFociSurfels = 1, kFociGaussians = 2, kFociMore = 3;

inline constexpr std::array<unsigned char, 8> kFociMagic = {'F',  'O',  'C',  'I',
                                                            '\r', '\n', 0x1a, '\n'};

struct FociHeader {
  std::array<unsigned char, 8> magic = kFociMagic;
  std::uint32_t version = kFociSurfels;
  std::uint32_t flags = 0;
  std::uint64_t count = 0;  ///< surfels or Gaussians
  std::uint64_t file_bytes = 0;
  std::uint64_t content_checksum = 0;
  std::array<std::uint64_t, 2> zero{};
  std::uint64_t header_checksum = 0;
};
static_assert(sizeof(FociHeader) == 64);

using ByteSpan = std::span<const unsigned char>;

template <typename T>
ByteSpan bytesOf(const std::vector<T>& values) {
  return {reinterpret_cast<const unsigned char*>(values.data()), values.size() * sizeof(T)};
}

/// Fills in sizes and checksums, and writes. @throws std::runtime_error
void writeFoci(const std::filesystem::path& path, FociHeader header,
               const std::vector<ByteSpan>& arrays);

/// A file, mapped for reading. Its header is sound.
class FociContainer {
 public:
  /// @throws InputError
  explicit FociContainer(const std::filesystem::path& path);
  ~FociContainer();
  FociContainer(const FociContainer&) = delete;
  FociContainer& operator=(const FociContainer&) = delete;

  const FociHeader& header() const { return header_; }

  /// @throws InputError  always, with the file's name
  [[noreturn]] void refuse(const std::string& why) const;

  /// The arrays of these numbers of bytes. @throws InputError if they are not the whole content, or
  /// it was altered
  std::vector<ByteSpan> arrays(const std::vector<std::uint64_t>& bytes) const;

  /// Frees the memory of an array, which can still be read: the file is mapped.
  static void release(ByteSpan array);

 private:
  ByteSpan bytes() const { return {static_cast<const unsigned char*>(at_), size_}; }
  void readHeader();

  std::string name_;
  void* at_ = nullptr;
  std::size_t size_ = 0;
  FociHeader header_;
};

}  // namespace foci
