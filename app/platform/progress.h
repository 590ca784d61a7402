// Progress of a long job on standard error: a bar on a terminal, a plain line every few seconds
// elsewhere.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace foci {

class Progress {
 public:
  /// @param what  e.g. "rendering"; `unit` e.g. "frames"; `total` > 0
  Progress(std::string what, std::string unit, std::size_t total);

  void advance(std::size_t done);

 private:
  using Clock = std::chrono::steady_clock;
  std::string what_, unit_;
  std::size_t total_;
  bool terminal_;
  Clock::time_point start_, shown_;
};

}  // namespace foci
