#include "render/scene/io/file_bytes.h"

#include <zlib.h>
#include <algorithm>
#include <bit>
#include <fstream>

#include "base/file.h"
#include "base/input_error.h"
#include "base/memory_budget.h"

namespace foci {
namespace {

static_assert(std::endian::native == std::endian::little);

/// The whole content of a gzip file.
std::vector<unsigned char> unpackedGzip(const std::string& name,
                                        std::span<const unsigned char> packed) {
  Gunzip stream(name, packed);
  MemoryBudget budget(name, packed.size());
  constexpr std::size_t kPart = std::size_t{1} << 24u;
  std::vector<unsigned char> all;
  for (;;) {
    budget.take(kPart, 2, "its content");
    const std::vector<unsigned char> part = stream.next(kPart);
    all.insert(all.end(), part.begin(), part.end());
    if (part.empty()) return all;
  }
}

constexpr std::uint32_t kEndMagic = 0x06054b50, kEntryMagic = 0x02014b50, kLocalMagic = 0x04034b50;
constexpr std::size_t kZipEnd = 22, kZipEntry = 46, kZipLocal = 30;
constexpr std::size_t kMaxComment = 0xffff;
/// Bytes for each packed one that deflate reaches at most (zlib's technical details: 1032).
constexpr std::uint64_t kMaxRatio = 1032;
constexpr unsigned kStored = 0, kDeflated = 8;

/// Place of the end record, which a comment may follow.
std::size_t endOf(const FileBytes& file) {
  for (std::size_t back = kZipEnd; back <= std::min(file.size(), kZipEnd + kMaxComment); ++back) {
    if (u32At(file.all(), file.size() - back) == kEndMagic) return file.size() - back;
  }
  throw InputError(file.name(), "is a damaged ZIP archive: it ends early");
}

/// Unpacks a raw deflate stream of exactly `count` bytes; nothing if it is none.
std::vector<unsigned char> inflated(std::span<const unsigned char> packed, std::uint64_t count) {
  std::vector<unsigned char> bytes(count);
  z_stream stream{};
  if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) return {};
  // zlib takes a pointer that is not const, and does not write through it.
  stream.next_in = const_cast<unsigned char*>(packed.data());  // NOLINT
  stream.avail_in = static_cast<uInt>(packed.size());
  stream.next_out = bytes.data();
  stream.avail_out = static_cast<uInt>(bytes.size());
  const int result = inflate(&stream, Z_FINISH);
  const bool whole = result == Z_STREAM_END && stream.avail_out == 0;
  inflateEnd(&stream);
  if (!whole) bytes.clear();
  return bytes;
}

}  // namespace

std::string unpackedExtension(const std::filesystem::path& file) {
  const std::string extension = lowerExtension(file);
  return extension == ".gz" ? lowerExtension(file.stem()) : extension;
}

FileBytes::FileBytes(const std::filesystem::path& path, bool unpacks_gzip) : name_(path.string()) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) throw InputError(name_, "no such file");
  file_ = std::make_unique<const MappedFile>(path);
  bytes_ = file_->bytes();
  if (!unpacks_gzip || !isGzip(bytes_)) return;
  unpacked_ = unpackedGzip(name_, bytes_);
  bytes_ = unpacked_;
  file_.reset();
}

std::span<const unsigned char> FileBytes::part(std::uint64_t at, std::uint64_t count) const {
  if (at > bytes_.size() || count > bytes_.size() - at) {
    throw InputError(name_, "ends at byte ", bytes_.size(), ", earlier than its header says");
  }
  return bytes_.subspan(at, count);
}

void FileBytes::release(std::uint64_t at, std::uint64_t count) const {
  if (file_) releasePages(part(at, count));
}

std::vector<unsigned char> firstBytes(const std::filesystem::path& path, std::size_t count) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return {};
  std::vector<unsigned char> bytes(count);
  std::ifstream file(path, std::ios::binary);
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(count));
  bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(file.gcount(), 0)));
  return bytes;
}

ZipArchive::ZipArchive(const FileBytes& file) : file_(file) {
  const std::size_t end = endOf(file);
  const unsigned count = u16At(file.all(), end + 10);
  std::uint64_t at = u32At(file.all(), end + 16);
  for (unsigned i = 0; i < count; ++i) {
    const auto entry = file.part(at, kZipEntry);
    if (u32At(entry, 0) != kEntryMagic) {
      throw InputError(file.name(), "is a damaged ZIP archive: its directory is no directory");
    }
    const std::uint64_t name_bytes = u16At(entry, 28);
    const auto name = file.part(at + kZipEntry, name_bytes);
    members_[std::string(name.begin(), name.end())] = {.method = u16At(entry, 10),
                                                       .checksum = u32At(entry, 16),
                                                       .packed_bytes = u32At(entry, 20),
                                                       .bytes = u32At(entry, 24),
                                                       .header_at = u32At(entry, 42)};
    at += kZipEntry + name_bytes + u16At(entry, 30) + u16At(entry, 32);
  }
}

std::vector<unsigned char> ZipArchive::read(const std::string& name,
                                            std::uint64_t max_bytes) const {
  const auto found = members_.find(name);
  if (found == members_.end()) throw InputError(file_.name(), "holds no ", name);
  const Member& member = found->second;
  const auto damaged = [&] { return InputError(file_.name(), "is damaged: ", name); };
  const auto header = file_.part(member.header_at, kZipLocal);
  if (u32At(header, 0) != kLocalMagic) throw damaged();
  if (member.bytes > kMaxRatio * (member.packed_bytes + 1)) throw damaged();
  if (member.bytes > max_bytes) {
    throw InputError(file_.name(), name, " has ", member.bytes, " bytes: expected at most ",
                     max_bytes);
  }
  const auto packed = file_.part(
      member.header_at + kZipLocal + u16At(header, 26) + u16At(header, 28), member.packed_bytes);
  std::vector<unsigned char> bytes;
  if (member.method == kStored && member.bytes == member.packed_bytes) {
    bytes.assign(packed.begin(), packed.end());
  } else if (member.method == kDeflated) {
    bytes = inflated(packed, member.bytes);
  } else {
    throw InputError(file_.name(), name, " is packed by method ", member.method,
                     ": expected stored or deflated");
  }
  const auto size = static_cast<uInt>(bytes.size());
  if (bytes.size() != member.bytes || crc32(0, bytes.data(), size) != member.checksum) {
    throw damaged();
  }
  return bytes;
}

}  // namespace foci
