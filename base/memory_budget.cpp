#include "base/memory_budget.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cassert>
#include <fstream>
#include <limits>
#include <system_error>
#include <utility>

#include "base/input_error.h"
#include "base/text.h"

namespace foci {
namespace {

constexpr std::uint64_t kAnyway = std::uint64_t{512} << 20, kPerByte = 64;

/// "1.25 GiB", "36 kB".
std::string sizeText(std::uint64_t bytes) {
  const auto size = static_cast<double>(bytes);
  if (size < 1e6) return decimal(size / 1e3, size < 1e4 ? 1 : 0) + " kB";
  return size < 1e9 ? decimal(size / 1e6, 0) + " MB" : decimal(size / 1e9, 1) + " GB";
}

}  // namespace

std::uint64_t memoryOfMachine() {
  const long pages = ::sysconf(_SC_PHYS_PAGES), page_bytes = ::sysconf(_SC_PAGESIZE);
  std::uint64_t bytes = std::numeric_limits<std::uint64_t>::max();
  if (pages > 0 && page_bytes > 0) {
    bytes = static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(page_bytes);
  }
  // Linux control groups, versions 2 and 1; "max" is no number.
  for (const char* file :
       {"/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"}) {
    std::ifstream in(file);
    std::uint64_t most = 0;
    if (in >> most && most > 0) bytes = std::min(bytes, most);
  }
  struct rlimit own {};
  if (::getrlimit(RLIMIT_AS, &own) == 0 && own.rlim_cur != RLIM_INFINITY) {
    bytes = std::min<std::uint64_t>(bytes, own.rlim_cur);
  }
  return bytes;
}

MemoryBudget::MemoryBudget(const std::filesystem::path& file) : name_(file.string()) {
  addFile(file);
}

MemoryBudget::MemoryBudget(std::string name, std::uint64_t input_bytes)
    : name_(std::move(name)), input_bytes_(input_bytes) {}

void MemoryBudget::addFile(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return;
  const auto bytes = std::filesystem::file_size(file, error);
  if (!error) input_bytes_ += bytes;
}

std::uint64_t MemoryBudget::limit() const {
  static const std::uint64_t most = memoryOfMachine() / 4 * 3;
  const std::uint64_t counted = std::min(input_bytes_, most / kPerByte);
  return std::min(kAnyway + kPerByte * counted, most);
}

std::uint64_t MemoryBudget::left() const {
  const std::uint64_t most = limit();
  return most > taken_ ? most - taken_ : 0;
}

void MemoryBudget::take(std::uint64_t count, std::uint64_t bytes_each, const std::string& what) {
  if (bytes_each == 0 || count <= left() / bytes_each) {
    taken_ += count * bytes_each;
    return;
  }
  const double wanted =
      static_cast<double>(count) * static_cast<double>(bytes_each) + static_cast<double>(taken_);
  const bool finite = wanted < 1e18;
  throw InputError(
      name_, what + " would take " +
                 (finite ? sizeText(static_cast<std::uint64_t>(wanted)) : "over 1,000,000,000 GB") +
                 " of memory in all: expected at most " + sizeText(limit()) + " for " +
                 sizeText(input_bytes_) + " of input");
}

void MemoryBudget::giveBack(std::uint64_t bytes) {
  assert(bytes <= taken_);
  taken_ -= bytes;
}

}  // namespace foci
