// The unit of time of a table that does not state it.
#pragma once

#include <vector>

#include "gaze/geometry/gaze_sample.h"
#include "gaze/sources/trace_reader.h"

namespace foci {

struct ClockGuess {
  double scale_s = 1.0;       ///< seconds per unit of time
  bool counts_rows = false;   ///< milliseconds that count by one: they may be row numbers
  bool may_be_ticks = false;  ///< microseconds of a slow tracker: they may be ticks of 100 ns
};

/// The largest of s, ms, us and ns that gives the rate of an eye tracker, or seconds.
/// @param samples  the first ones, with times in the file's unit
ClockGuess guessClock(const std::vector<GazeSample>& samples);

/// Adds the assumption, and what may be wrong with it.
void stateClockGuess(const ClockGuess& guess, TraceHeader& header);

}  // namespace foci
