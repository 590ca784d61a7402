// The one way to spread work over threads.
#pragma once

#include <cstddef>

#if defined(__SANITIZE_THREAD__)
#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>
#else
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <tbb/task.h>
#endif

namespace foci {

/// Thrown out of work whose enclosing tbb::task_group_context was cancelled.
struct Cancelled {};

/// Calls `body(i)` for i in [0, n), on as many threads as the enclosing tbb::global_control allows,
/// and returns when all are done. Bodies run in any order and must not touch what another one
/// writes: then the result does not depend on the threads.
/// @throws Cancelled where not all bodies were called
///
/// The thread sanitizer cannot see into the scheduling library, which is not instrumented: there,
/// plain threads do the same.
template <typename Body>
void parallelFor(std::size_t n, const Body& body) {
#if defined(__SANITIZE_THREAD__)
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < n; i = next++) body(i);
  };
  std::vector<std::jthread> threads(3);
  for (std::jthread& thread : threads) thread = std::jthread(work);
  work();
#else
  tbb::parallel_for(std::size_t{0}, n, body);
  if (tbb::is_current_task_group_canceling()) throw Cancelled();
#endif
}

/// Sorts; elements that compare equal must be the same, or their order hangs on the threads.
template <typename Iterator>
void parallelSort(Iterator begin, Iterator end) {
#if defined(__SANITIZE_THREAD__)
  std::sort(begin, end);
#else
  tbb::parallel_sort(begin, end);
#endif
}

}  // namespace foci
