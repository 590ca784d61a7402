#include "base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <thread>

namespace foci {
namespace FOCI_FILE {

using std::chrono::steady_clock;

TEST(Gate, HoldsTheRangesOfItsThread) {
  Gate gate;
  std::atomic<bool> closed = true, started = false, waited = false;
  gate.close();
  std::jthread behind([&] {
    passBeforeRanges(&gate);
    const auto start = steady_clock::now();
    started = true;
    parallelFor(1, [&](std::size_t) {
      waited = !closed || steady_clock::now() - start >= Gate::kLongestWait;
    });
  });
  while (!started) std::this_thread::yield();
  std::this_thread::sleep_for(std::chrono::milliseconds(5));
  closed = false;
  gate.open();
  behind.join();
  EXPECT_TRUE(waited);
}

TEST(Gate, LetsOtherThreadsThrough) {
  Gate gate;
  gate.close();
  std::jthread([&] { passBeforeRanges(&gate); }).join();
  constexpr int kTimes = 100;
  const auto start = steady_clock::now();
  for (int k = 0; k < kTimes; ++k) parallelFor(1, [](std::size_t) {});
  EXPECT_LT(steady_clock::now() - start, kTimes * Gate::kLongestWait);
}

TEST(Gate, IsPassedInTheEnd) {
  Gate gate;
  gate.close();
  const auto start = steady_clock::now();
  gate.pass();
  EXPECT_GE(steady_clock::now() - start, Gate::kLongestWait);
}

}  // namespace FOCI_FILE
}  // namespace foci
