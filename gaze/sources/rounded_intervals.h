// The rate of a recording whose times are whole milliseconds: at 60 Hz, intervals are 16 and 17 ms,
// and their median would give 58.8 Hz.
#pragma once

#include <cmath>
#include <cstddef>
#include <optional>

namespace foci {

inline bool isWhole_ms(double interval_s) {
  constexpr double kSlack_ms = 1e-3;  // of a double that holds a date in seconds
  return std::abs(1e3 * interval_s - std::round(1e3 * interval_s)) < kSlack_ms;
}

/// The mean of the intervals within a millisecond of the median. Longer ones are gaps.
class RoundedIntervals {
 public:
  explicit RoundedIntervals(double median_s) : median_s_(median_s) {}

  /// Intervals that are nearly equal.
  void add(std::size_t count, double sum_s) {
    if (count == 0) return;
    const double off_ms = 1e3 * std::abs(sum_s / static_cast<double>(count) - median_s_);
    if (off_ms > 1.5) return;
    count_ += count;
    sum_s_ += sum_s;
    if (off_ms > 0.5) beside_ += count;
  }

  /// Absent if the median holds: fewer than a tenth of the intervals lie beside it.
  std::optional<double> mean_s() const {
    if (10 * beside_ < count_ || !(sum_s_ > 0.0)) return std::nullopt;
    return sum_s_ / static_cast<double>(count_);
  }

 private:
  double median_s_, sum_s_ = 0.0;
  std::size_t count_ = 0, beside_ = 0;
};

}  // namespace foci
