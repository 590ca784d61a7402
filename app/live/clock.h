// The clock of a live run, in whole microseconds since the program started. A record writes six
// decimals, so the times that it is read back with are the same.
#pragma once

#include <chrono>

#include "app/record/record_files.h"

namespace foci {

class LiveClock {
 public:
  /// @param rate  its seconds per second of real time; above 1 for tests of long runs
  explicit LiveClock(double rate = 1.0) : rate_(rate) {}

  double now_s() const {
    return wholeMicroseconds(
        rate_ * std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count());
  }
  std::chrono::steady_clock::time_point at(double time_s) const {
    return start_ + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                        std::chrono::duration<double>(time_s / rate_));
  }

 private:
  double rate_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace foci
