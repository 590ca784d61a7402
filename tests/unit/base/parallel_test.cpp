#include "base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <mutex>
#include <thread>

namespace foci {
namespace FOCI_FILE {

using std::chrono::steady_clock;

TEST(Gate, HoldsTheRangesOfItsThread) {
  Gate gate;
  std::atomic<bool> closed = true, started = false, waited = false;
  gate.lock();
  std::jthread behind([&] {
    passBeforeRanges(&gate);
    const auto start = steady_clock::now();
    started = true;
    parallelFor(
        1, [&](std::size_t) { waited = !closed || steady_clock::now() - start >= kMaxGateWait; });
  });
  while (!started) std::this_thread::yield();
  std::this_thread::sleep_for(std::chrono::milliseconds(5));
  closed = false;
  gate.unlock();
  behind.join();
  EXPECT_TRUE(waited);
}

TEST(Gate, LetsOtherThreadsThrough) {
  Gate gate;
  const std::lock_guard lock(gate);
  std::jthread([&] { passBeforeRanges(&gate); }).join();
  constexpr int kTimes = 100;
  const auto start = steady_clock::now();
  for (int k = 0; k < kTimes; ++k) parallelFor(1, [](std::size_t) {});
  EXPECT_LT(steady_clock::now() - start, kTimes * kMaxGateWait);
}

TEST(Gate, IsPassedInTheEnd) {
  Gate gate;
  const std::lock_guard lock(gate);
  const auto start = steady_clock::now();
  std::jthread([&] {
    passBeforeRanges(&gate);
    parallelFor(1, [](std::size_t) {});
  }).join();
  EXPECT_GE(steady_clock::now() - start, kMaxGateWait);
}

}  // namespace FOCI_FILE
}  // namespace foci
