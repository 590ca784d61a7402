// The one way to spread work over threads.
#pragma once

#include <tbb/parallel_for.h>

#include <cstddef>

#if defined(__SANITIZE_THREAD__)
extern "C" void __tsan_acquire(void*);
extern "C" void __tsan_release(void*);
#endif

namespace foci {

/// Calls `body(i)` for i in [0, n), on as many threads as the enclosing tbb::global_control allows,
/// and returns when all are done. Bodies run in any order and must not touch what another one
/// writes: then the result does not depend on the threads. The library that schedules them is not
/// instrumented, so the thread sanitizer is told here of fork and join, which it would not see.
template <typename Body>
void parallelFor(std::size_t n, const Body& body) {
#if defined(__SANITIZE_THREAD__)
  char fork = 0, join = 0;
  __tsan_release(&fork);
  tbb::parallel_for(std::size_t{0}, n, [&](std::size_t i) {
    __tsan_acquire(&fork);
    body(i);
    __tsan_release(&join);
  });
  __tsan_acquire(&join);
#else
  tbb::parallel_for(std::size_t{0}, n, body);
#endif
}

}  // namespace foci
