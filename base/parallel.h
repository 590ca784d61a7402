// Work spread over threads. All threads of the libraries start here.
#pragma once

#include <cstddef>
#include <functional>

#ifdef FOCI_TSAN
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

/// Thrown by `parallelFor` when its enclosing tbb::task_group_context was cancelled.
struct Cancelled {};

/// Calls `body(i)` for each i in [0, n) and returns after the last call. It uses as many threads as
/// the enclosing tbb::global_control allows. Calls run in any order. No call may touch memory that
/// another one writes; then the result does not depend on the number of threads.
/// @throws Cancelled if not all bodies were called
///
/// TBB is not instrumented for the thread sanitizer. Sanitized builds use plain threads instead.
template <typename Body>
void parallelFor(std::size_t n, const Body& body) {
#ifdef FOCI_TSAN
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

/// Sorts. Elements that compare equal must be identical, or their order depends on the threads.
template <typename Iterator, typename Less = std::less<>>
void parallelSort(Iterator begin, Iterator end, const Less& less = {}) {
#ifdef FOCI_TSAN
  std::sort(begin, end, less);
#else
  tbb::parallel_sort(begin, end, less);
#endif
}

}  // namespace foci
