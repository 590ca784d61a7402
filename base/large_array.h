// Large arrays that a frame fills: memory without initial values, in huge pages where the system
// offers them. The first frame then waits for few pages instead of tens of thousands.
#pragma once

#include <cstddef>
#include <memory>
#include <type_traits>

namespace foci {

/// Memory for `bytes`, aligned to a huge page if it is large enough for some, and to a cache line
/// else. @throws std::bad_alloc
void* allocateLarge(std::size_t bytes);
void freeLarge(void* memory) noexcept;

struct FreeLarge {
  void operator()(void* memory) const noexcept { freeLarge(memory); }
};

/// `n` elements that are unset.
template <typename T>
using LargeArray = std::unique_ptr<T[], FreeLarge>;

template <typename T>
LargeArray<T> makeLargeArray(std::size_t n) {
  static_assert(std::is_trivially_default_constructible_v<T> &&
                std::is_trivially_destructible_v<T>);
  return LargeArray<T>(static_cast<T*>(allocateLarge(n * sizeof(T))));
}

}  // namespace foci
