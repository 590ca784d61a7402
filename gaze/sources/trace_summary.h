// A summary of a recording, gathered sample by sample in constant memory.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "gaze/geometry/gaze_sample.h"

namespace foci {

inline bool isWhole_ms(double interval_s) {
  constexpr double kSlack_ms = 1e-3;  // of a double that holds a date in seconds
  return std::abs(1e3 * interval_s - std::round(1e3 * interval_s)) < kSlack_ms;
}

/// The rate of a recording whose times are whole milliseconds: at 60 Hz, intervals are 16 and 17
/// ms, and their median would give 58.8 Hz. The mean of the intervals within a millisecond of the
/// median. Longer ones are gaps.
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

  /// To a thousandth. By the median if fewer than a tenth of the intervals lie beside it.
  double rate_Hz() const {
    const bool by_median = 10 * beside_ < count_ || !(sum_s_ > 0.0);
    const double usual_s = by_median ? median_s_ : sum_s_ / static_cast<double>(count_);
    return std::round(1000.0 / usual_s) / 1000.0;
  }

 private:
  double median_s_, sum_s_ = 0.0;
  std::size_t count_ = 0, beside_ = 0;
};

class TraceSummary {
 public:
  void add(const GazeSample& sample);

  std::size_t samples() const { return samples_; }
  double first_s() const { return first_s_; }
  double span_s() const { return last_s_ - first_s_; }
  /// Sampling rate from the median interval, exact to a fiftieth; 0 with fewer than two samples.
  /// From the mean of the intervals beside the median if times are whole milliseconds.
  double rate_Hz() const;
  std::size_t present() const { return present_; }  ///< samples with a point
  std::size_t blinks() const { return blinks_; }    ///< samples that the tracker reports as blinks
  std::size_t pupils() const { return pupils_; }    ///< samples with a pupil, in any unit
  std::size_t pauses() const { return pauses_; }    ///< that the recording itself states
  std::array<std::size_t, 2> eyes() const { return eyes_; }  ///< samples with a left, a right eye
  /// Intervals longer than a tenth of a second and than three times the median interval so far.
  std::size_t jumps() const { return jumps_; }
  double longest_jump_s() const { return longest_jump_s_; }
  glm::dvec2 min_px() const { return min_px_; }  ///< of all points, along each axis
  glm::dvec2 max_px() const { return max_px_; }

 private:
  // The histogram of intervals has equal bins within each octave, from a microsecond up.
  static constexpr int kPerOctave = 35;
  static constexpr int kOctaves = 24;
  int binOf(double interval_s) const;
  int medianBin() const;
  void noteJump(double interval_s);

  std::size_t samples_ = 0, present_ = 0, blinks_ = 0, pupils_ = 0, jumps_ = 0, pauses_ = 0;
  std::array<std::size_t, 2> eyes_{};
  double first_s_ = 0.0, last_s_ = 0.0, longest_jump_s_ = 0.0;
  glm::dvec2 min_px_{0.0}, max_px_{0.0};
  std::array<std::size_t, kPerOctave * kOctaves> intervals_{};
  std::array<double, kPerOctave * kOctaves> sums_s_{};  // of the intervals in each bin
  bool whole_ms_ = true;                                // all intervals
  double usual_s_ = 0.0;                                // median interval, updated at times
  std::vector<double> early_s_{};                       // intervals before it is known
};

}  // namespace foci
