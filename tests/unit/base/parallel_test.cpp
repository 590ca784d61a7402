#include "base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

namespace foci {
namespace {

using std::chrono::steady_clock;
constexpr std::chrono::milliseconds kLongestWait{50};

TEST(Gate, HoldsTheRangesOfItsThreadAlone) {
  Gate gate;
  std::atomic<bool> closed = true, waited = false;
  gate.close();
  std::jthread behind([&] {
    passBeforeRanges(&gate);
    const auto start = steady_clock::now();
    parallelFor(
        1, [&](std::size_t) { waited = !closed || steady_clock::now() - start >= kLongestWait; });
  });
  bool ran = false;
  parallelFor(1, [&](std::size_t) { ran = true; });
  EXPECT_TRUE(ran);
  std::this_thread::sleep_for(std::chrono::milliseconds(5));
  closed = false;
  gate.open();
  behind.join();
  EXPECT_TRUE(waited);
}

TEST(Gate, IsPassedInTheEnd) {
  Gate gate;
  gate.close();
  const auto start = steady_clock::now();
  gate.pass();
  EXPECT_GE(steady_clock::now() - start, kLongestWait);
}

}  // namespace
}  // namespace foci
