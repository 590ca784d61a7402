// Work spread over threads. All threads of the libraries start here.
#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>

namespace foci {

/// Thrown by `parallelFor` when its enclosing tbb::task_group_context was cancelled.
struct Cancelled {};

/// Calls `work(body, begin, end)` for ranges that together are [0, n), and returns after the last
/// call. It uses as many threads as the enclosing tbb::global_control allows.
/// @throws Cancelled if not all ranges were worked on
///
/// Here so that TBB is compiled once: its headers take longer to compile than most sources.
void parallelRanges(std::size_t n,
                    void (*work)(const void* body, std::size_t begin, std::size_t end),
                    const void* body);

/// Calls `body(i)` for each i in [0, n) and returns after the last call. It uses as many threads as
/// the enclosing tbb::global_control allows. Calls run in any order. No call may touch memory that
/// another one writes; then the result does not depend on the number of threads.
/// @throws Cancelled if not all bodies were called
template <typename Body>
void parallelFor(std::size_t n, const Body& body) {
  parallelRanges(
      n,
      [](const void* erased, std::size_t begin, std::size_t end) {
        const Body& each = *static_cast<const Body*>(erased);
        for (std::size_t i = begin; i < end; ++i) each(i);
      },
      &body);
}

/// Held by a thread while its work is urgent.
using Gate = std::timed_mutex;
inline constexpr std::chrono::milliseconds kMaxGateWait{20};

/// From now on, the calling thread waits before each range that it works on while another thread
/// holds the gate: for kMaxGateWait at most, so that they cannot wait for each other. Threads that
/// help it do not wait: TBB takes them away by the arena's priority.
/// @param gate  outlives the thread
void passBeforeRanges(Gate* gate);

/// Number of threads that the enclosing tbb::global_control allows.
unsigned maxThreads();

}  // namespace foci
