#include "base/large_array.h"

#include <sys/mman.h>

#include <cstdlib>
#include <new>

namespace foci {
namespace {

constexpr std::size_t kCacheLine = 64, kHugePage = std::size_t{1} << 21;

/// Smaller arrays may be filled only in parts, and a huge page is cleared as a whole.
constexpr std::size_t kLarge = 4 * kHugePage;

}  // namespace

void* allocateLarge(std::size_t bytes) {
  const std::size_t alignment = bytes < kLarge ? kCacheLine : kHugePage;
  const std::size_t rounded = (bytes / alignment + 1) * alignment;
  void* memory = std::aligned_alloc(alignment, rounded);
  if (memory == nullptr) throw std::bad_alloc();
#ifdef MADV_HUGEPAGE
  // A hint: if the system refuses, pages stay small.
  if (bytes >= kLarge) madvise(memory, rounded, MADV_HUGEPAGE);
#endif
  return memory;
}

void freeLarge(void* memory) noexcept { std::free(memory); }

}  // namespace foci
