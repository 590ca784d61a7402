#include "base/parallel.h"

#ifdef FOCI_TSAN
#include <atomic>
#include <thread>
#include <vector>
#else
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task.h>
#endif

namespace foci {
namespace {

thread_local Gate* gate_of_thread = nullptr;

void passGate() {
  // Not try_lock_for: the thread sanitizer does not know the steady clock's lock.
  Gate* const gate = gate_of_thread;
  if (gate && gate->try_lock_until(std::chrono::system_clock::now() + kMaxGateWait)) gate->unlock();
}

}  // namespace

void passBeforeRanges(Gate* gate) { gate_of_thread = gate; }

// TBB is not instrumented for the thread sanitizer. Sanitized builds use plain threads instead.
void parallelRanges(std::size_t n,
                    void (*work)(const void* body, std::size_t begin, std::size_t end),
                    const void* body) {
#ifdef FOCI_TSAN
  std::atomic<std::size_t> next{0};
  const auto work_on = [&] {
    for (std::size_t i = next++; i < n; i = next++) {
      passGate();
      work(body, i, i + 1);
    }
  };
  const auto help = [&work_on, gate = gate_of_thread] {
    passBeforeRanges(gate);
    work_on();
  };
  std::vector<std::jthread> threads(3);
  for (std::jthread& thread : threads) thread = std::jthread(help);
  work_on();
#else
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      passGate();
                      work(body, range.begin(), range.end());
                    });
  if (tbb::is_current_task_group_canceling()) throw Cancelled();
#endif
}

unsigned maxThreads() {
#ifdef FOCI_TSAN
  return 4;
#else
  return static_cast<unsigned>(
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
#endif
}

}  // namespace foci
