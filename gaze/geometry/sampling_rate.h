// Sampling rates that change within a recording: blocks of another rate, a headset that slows down.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// Samples of one rate, up to the next stretch.
struct RateStretch {
  std::size_t first = 0;  ///< number of its first sample
  double time_s = 0.0;    ///< of that sample
  double rate_Hz = 0.0;
};

/// Notices that samples come at another rate, causally. Most intervals of half a second, and of 16
/// samples, have to be longer, or most have to be shorter, by a factor of 1.4.
class RateWatch {
 public:
  /// @param rate_Hz  nominal; 0: the usual rate of the first samples
  explicit RateWatch(double rate_Hz = 0.0) : rate_Hz_(rate_Hz) {}

  /// @param time_s  later than the one before
  /// @return the new stretch, which began a little before this sample
  std::optional<RateStretch> push(double time_s);

  double rate_Hz() const { return rate_Hz_; }  ///< of the latest stretch; 0: not yet known

 private:
  struct Interval {
    double length_s = 0.0;
    int side = 0;  ///< -1: short, 1: long
  };

  std::optional<RateStretch> change(int side);
  double newestRate_Hz(std::size_t intervals) const;

  double rate_Hz_;
  std::size_t count_ = 0;
  double last_s_ = 0.0;
  std::deque<Interval> recent_{};
  std::size_t short_ = 0, long_ = 0;  // of `recent_`
  RateStretch run_{};                 // of intervals on one side
  int run_side_ = 0;
};

/// The stretches of a recording. A recording of one rate is one stretch at `trace.rate_Hz`.
std::vector<RateStretch> rateStretchesOf(const GazeTrace& trace);

/// The samples of stretch `i`, with its rate.
GazeTrace stretchOf(const GazeTrace& trace, const std::vector<RateStretch>& stretches,
                    std::size_t i);

}  // namespace foci
