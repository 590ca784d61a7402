#include "render/scene/io/foci_container.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>

#include "base/parallel.h"

namespace foci {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::size_t kBlock = 1 << 20;

/// FNV-1a over words of eight bytes, the last one padded with zeros. Each step is a bijection of
/// the state, so a change within one word always changes the result.
class Checksum {
 public:
  void add(std::uint64_t word) { state_ = (state_ ^ word) * 0x100000001b3; }
  void add(std::span<const unsigned char> bytes) {
    std::uint64_t word = 0;
    for (; bytes.size() >= 8; bytes = bytes.subspan(8)) {
      std::memcpy(&word, bytes.data(), 8);
      add(word);
    }
    word = 0;
    if (!bytes.empty()) std::memcpy(&word, bytes.data(), bytes.size());
    add(word ^ std::uint64_t{bytes.size()} << 56);
  }
  std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0xcbf29ce484222325;
};

std::uint64_t checksumOf(const FociHeader& header) {
  Checksum sum;
  sum.add({reinterpret_cast<const unsigned char*>(&header), offsetof(FociHeader, header_checksum)});
  return sum.value();
}

/// The checksum of an array of a mapped file: that of its blocks' checksums, which are computed in
/// parallel. Releases the pages.
std::uint64_t checksumOf(std::span<const unsigned char> bytes) {
  std::vector<std::uint64_t> blocks((bytes.size() + kBlock - 1) / kBlock);
  parallelFor(blocks.size(), [&](std::size_t i) {
    const ByteSpan block = bytes.subspan(i * kBlock, std::min(kBlock, bytes.size() - i * kBlock));
    Checksum sum;
    sum.add(block);
    blocks[i] = sum.value();
    releasePages(block);
  });
  Checksum sum;
  for (const std::uint64_t block : blocks) sum.add(block);
  return sum.value();
}

}  // namespace

FociWriter::FociWriter(const std::filesystem::path& path, const FociHeader& header,
                       const std::vector<std::uint64_t>& sizes, std::uint64_t align)
    : path_(path), header_(header) {
  std::uint64_t at = sizeof(FociHeader);
  for (const std::uint64_t size : sizes) {
    begin_.push_back(at);
    at += aligned(size, align);
  }
  begin_.push_back(at);
  header_.file_bytes = at;
  file_.emplace(path, at);
}

void FociWriter::write(std::size_t array, std::uint64_t at, ByteSpan bytes) {
  assert(begin_[array] + at + bytes.size() <= begin_[array + 1]);
  file_->put(begin_[array] + at, bytes);
}

void FociWriter::finish() {
  const MappedFile written(path_);
  Checksum content;
  for (std::size_t i = 0; i + 1 < begin_.size(); ++i) {
    content.add(checksumOf(written.bytes().subspan(begin_[i], begin_[i + 1] - begin_[i])));
  }
  header_.content_checksum = content.value();
  header_.header_checksum = checksumOf(header_);
  file_->put(0, {reinterpret_cast<const unsigned char*>(&header_), sizeof(header_)});
}

void writeFoci(const std::filesystem::path& path, const FociHeader& header,
               const std::vector<ByteSpan>& arrays) {
  std::vector<std::uint64_t> sizes(arrays.size());
  std::ranges::transform(arrays, sizes.begin(), [](const ByteSpan& array) { return array.size(); });
  FociWriter writer(path, header, sizes);
  for (std::size_t i = 0; i < arrays.size(); ++i) writer.write(i, 0, arrays[i]);
  writer.finish();
}

FociContainer::FociContainer(const std::filesystem::path& path, std::uint64_t checked_B)
    : file_(path), checked_(file_.bytes().size() <= checked_B) {
  readHeader();
  checked_ = checked_ || header_.version != kFociTree;  // which are read into memory anyway
}

void FociContainer::readHeader() {
  const ByteSpan bytes = file_.bytes();
  const std::size_t start = std::min(bytes.size(), kFociMagic.size());
  if (start == 0 ||
      std::memcmp(bytes.data(), kFociMagic.data(), std::min<std::size_t>(start, 4)) != 0) {
    refuse("is not a .foci scene");
  }
  if (bytes.size() < sizeof(FociHeader)) {
    refuse("is cut short: ", bytes.size(), " bytes, a header has 64");
  }
  std::memcpy(&header_, bytes.data(), sizeof(header_));
  if (header_.magic != kFociMagic) refuse("was altered, as by a transfer as text");
  if (header_.version != kFociGaussians && header_.version != kFociTree) {
    refuse("is of version ", header_.version, ": this program reads versions ", kFociGaussians,
           " and ", kFociTree, "; foci prepare makes it again");
  }
  if (compare_foci_checksums && header_.header_checksum != checksumOf(header_))
    refuse("was altered: its header does not match");
}

std::vector<ByteSpan> FociContainer::arrays(const std::vector<std::uint64_t>& bytes,
                                            std::uint64_t align) const {
  const std::uint64_t size = file_.bytes().size();
  std::uint64_t expected = sizeof(FociHeader);
  for (const std::uint64_t each : bytes) expected += aligned(each, align);
  if (header_.file_bytes != expected) {
    refuse("is not a .foci scene: its sizes contradict each other");
  }
  if (size != expected) {
    refuse(std::string(size < expected ? "is cut short" : "is too long"), ": ", size, " bytes of ",
           expected);
  }
  std::vector<ByteSpan> all;
  std::size_t at = sizeof(FociHeader);
  Checksum content;
  for (const std::uint64_t each : bytes) {
    const ByteSpan padded = file_.bytes().subspan(at, aligned(each, align));
    all.push_back(padded.first(each));
    at += padded.size();
    if (!checked_) continue;
    content.add(checksumOf(padded));
  }
  if (checked_ && compare_foci_checksums && content.value() != header_.content_checksum)
    refuse("was altered: its checksum does not match");
  return all;
}

}  // namespace foci
