#include "render/scene/io/foci_container.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cstdio>
#include <cstring>
#include <memory>
#include <stdexcept>

#include "base/input_error.h"
#include "base/parallel.h"

namespace foci {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::size_t kBlock = 1 << 20;
#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
constexpr bool kChecksums = false;  // a fuzzer would never pass them
#else
constexpr bool kChecksums = true;
#endif

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

/// The checksum of an array: that of its blocks' checksums, which are computed in parallel.
std::uint64_t checksumOf(std::span<const unsigned char> bytes) {
  std::vector<std::uint64_t> blocks((bytes.size() + kBlock - 1) / kBlock);
  parallelFor(blocks.size(), [&](std::size_t i) {
    Checksum sum;
    sum.add(bytes.subspan(i * kBlock, std::min(kBlock, bytes.size() - i * kBlock)));
    blocks[i] = sum.value();
  });
  Checksum sum;
  for (const std::uint64_t block : blocks) sum.add(block);
  return sum.value();
}

}  // namespace

void writeFoci(const std::filesystem::path& path, FociHeader header,
               const std::vector<ByteSpan>& arrays) {
  Checksum content;
  header.file_bytes = sizeof(FociHeader);
  for (const ByteSpan& array : arrays) {
    content.add(checksumOf(array));
    header.file_bytes += array.size();
  }
  header.content_checksum = content.value();
  header.header_checksum = checksumOf(header);

  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  const std::unique_ptr<std::FILE, Close> file(std::fopen(path.c_str(), "wb"));
  bool good = file && std::fwrite(&header, sizeof(header), 1, file.get()) == 1;
  for (const ByteSpan& array : arrays) {
    good = good && (array.empty() ||
                    std::fwrite(array.data(), 1, array.size(), file.get()) == array.size());
  }
  good = good && std::fflush(file.get()) == 0;
  if (!good) throw std::runtime_error(path.string() + ": cannot be written");
}

FociContainer::FociContainer(const std::filesystem::path& path) : name_(path.string()) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  struct stat status {};
  if (file < 0 || ::fstat(file, &status) != 0 || !S_ISREG(status.st_mode)) {
    if (file >= 0) ::close(file);
    refuse("cannot be read");
  }
  size_ = static_cast<std::size_t>(status.st_size);
  if (size_ > 0) at_ = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, file, 0);
  ::close(file);
  if (at_ == MAP_FAILED) refuse("cannot be read");
  try {
    readHeader();
  } catch (...) {
    if (at_ != nullptr) ::munmap(at_, size_);
    throw;
  }
}

FociContainer::~FociContainer() {
  if (at_ != nullptr) ::munmap(at_, size_);
}

void FociContainer::refuse(const std::string& why) const { throw InputError(name_, why); }

void FociContainer::readHeader() {
  const std::size_t start = std::min(size_, kFociMagic.size());
  if (start == 0 || std::memcmp(at_, kFociMagic.data(), std::min<std::size_t>(start, 4)) != 0) {
    refuse("is not a .foci scene");
  }
  if (size_ < sizeof(FociHeader)) {
    refuse("is cut short: " + std::to_string(size_) + " bytes, a header has 64");
  }
  std::memcpy(&header_, at_, sizeof(header_));
  if (header_.magic != kFociMagic) refuse("was altered, as by a transfer as text");
  if (header_.version > kFociMore) {
    refuse("is of version " + std::to_string(header_.version) + ": this program reads versions " +
           std::to_string(kFociSurfels) + " to " + std::to_string(kFociMore));
  }
  if (kChecksums && header_.header_checksum != checksumOf(header_))
    refuse("was altered: its header does not match");
  if (header_.version == 0) refuse("is not a .foci scene");
}

void FociContainer::release(ByteSpan array) {
  static const auto page = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
  const auto begin = reinterpret_cast<std::uintptr_t>(array.data());
  const std::uintptr_t first = (begin + page - 1) / page * page - begin;  // whole pages only
  const std::uintptr_t end = (begin + array.size()) / page * page - begin;
  if (begin + end <= begin + first) return;
  ::madvise(const_cast<unsigned char*>(array.data()) + first, end - first, MADV_DONTNEED);
}

std::vector<ByteSpan> FociContainer::arrays(const std::vector<std::uint64_t>& bytes) const {
  std::uint64_t expected = sizeof(FociHeader);
  for (const std::uint64_t each : bytes) expected += each;
  if (header_.file_bytes != expected) {
    refuse("is not a .foci scene: its sizes contradict each other");
  }
  if (size_ != expected) {
    refuse(std::string(size_ < expected ? "is cut short" : "is too long") + ": " +
           std::to_string(size_) + " bytes of " + std::to_string(expected));
  }
  std::vector<ByteSpan> all;
  std::size_t at = sizeof(FociHeader);
  Checksum content;
  for (const std::uint64_t each : bytes) {
    all.push_back(this->bytes().subspan(at, each));
    at += each;
    content.add(checksumOf(all.back()));
    release(all.back());
  }
  if (kChecksums && content.value() != header_.content_checksum)
    refuse("was altered: its checksum does not match");
  return all;
}

}  // namespace foci
