// A summary of a recording, gathered sample by sample in constant memory.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// The step that the times of a recording are rounded to: 10, 1, .1 or .01 ms.
class TimeStep {
 public:
  void add(double interval_s) {
    constexpr double kSlack_s = 1e-6;  // of a double that holds a date in seconds
    while (s_ > 0.0 && std::abs(interval_s - s_ * std::round(interval_s / s_)) > kSlack_s) {
      s_ = s_ > 2e-5 ? 0.1 * s_ : 0.0;
    }
  }
  double step_s() const { return s_; }  ///< 0: none of these

 private:
  double s_ = 0.01;
};

/// The rate of a recording whose times are rounded: at 60 Hz and whole milliseconds, intervals are
/// 16 and 17 ms, and their median would give 58.8 Hz. The mean of the intervals within a step and a
/// half of the median. Longer ones are gaps. Without a step, the median.
class RoundedIntervals {
 public:
  RoundedIntervals(double median_s, double step_s) : median_s_(median_s), step_s_(step_s) {}

  /// Intervals that are nearly equal.
  void add(std::size_t count, double sum_s) {
    if (count == 0) return;
    const double off_s = sum_s / static_cast<double>(count) - median_s_;
    if (std::abs(off_s) > 1.5 * step_s_) return;
    count_ += count;
    sum_s_ += sum_s;
    if (off_s < -0.5 * step_s_) below_ += count;
    if (off_s > 0.5 * step_s_) above_ += count;
  }

  /// To a thousandth. By the median if fewer than a tenth of the intervals lie beside it. In steps
  /// of 10 ms, 20 ms beside a median of 10 are those of a lost sample rather than of 75 Hz.
  double rate_Hz() const {
    const bool lost = step_s_ > 5e-3 && median_s_ < 1.5 * step_s_;
    const std::size_t beside = below_ + (lost ? 0 : above_);
    const bool by_median = 10 * beside < count_ || !(sum_s_ > 0.0);
    const double usual_s = by_median ? median_s_ : sum_s_ / static_cast<double>(count_);
    return std::round(1000.0 / usual_s) / 1000.0;
  }

 private:
  double median_s_, step_s_, sum_s_ = 0.0;
  std::size_t count_ = 0, below_ = 0, above_ = 0;
};

class TraceSummary {
 public:
  void add(const GazeSample& sample);

  std::size_t samples() const { return samples_; }
  double first_s() const { return first_s_; }
  double span_s() const { return last_s_ - first_s_; }
  /// Sampling rate from the median interval, exact to a fiftieth; 0 with fewer than two samples.
  /// From the mean of the intervals beside the median if times are rounded.
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
  TimeStep step_{};
  double usual_s_ = 0.0;           // median interval, updated at times
  std::vector<double> early_s_{};  // intervals before it is known
};

// Trials of an experiment, from the messages of a recording.

/// The first word of a message that begins a trial, after the rules of EyeLink's Data Viewer.
inline constexpr std::string_view kTrialMessage = "TRIALID";

/// A message that begins with `start` begins a trial, whose name is the rest of it, or all of it if
/// there is no rest. The trial ends with TRIAL_RESULT, with the next trial or at `end_s`; between,
/// `!V TRIAL_VAR name value` states a variable.
/// @param messages  in order of time
std::vector<TraceTrial> trialsIn(const std::vector<TraceMarker>& messages, std::string_view start,
                                 double end_s);

/// The trial at a time, of several the one that began last; null between trials.
/// @param trials  in order of their beginnings
const TraceTrial* trialDuring(const std::vector<TraceTrial>& trials, double time_s);

/// Its name as a field of a table; "n/a" between trials.
std::string trialAt(const std::vector<TraceTrial>& trials, double time_s);

}  // namespace foci
