// The clock of a live run: whole microseconds since the program started, so that a record that is
// read back has the same times.
#pragma once

#include <chrono>

#include "app/record_files.h"

namespace foci {

class LiveClock {
 public:
  double now_s() const {
    return wholeMicroseconds(
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count());
  }
  std::chrono::steady_clock::time_point at(double time_s) const {
    return start_ + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                        std::chrono::duration<double>(time_s));
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace foci
