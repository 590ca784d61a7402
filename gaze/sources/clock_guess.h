// The unit of time of a table that does not state it.
#pragma once

#include <string>
#include <vector>

#include "gaze/geometry/gaze_sample.h"
#include "gaze/sources/trace_reader.h"

namespace foci {

struct ClockGuess {
  double scale_s = 1.0;   ///< seconds per unit of time
  std::string why{};      ///< what makes the unit likely; empty: the rate alone
  std::string doubt{};    ///< a warning; empty: none
  std::string refusal{};  ///< why the unit cannot be told; empty: it can
  bool is_open = false;   ///< more samples may tell more
};

/// The unit that gives the rate of an eye tracker: s, ms, us or ns; 100 ns (the ticks of .NET and
/// Windows), 0.1 ms or minutes only if the rate is a usual one. A time since 1970, 1601 or the year
/// 1 tells the unit itself. If two units are left, the usual duration of a fixation tells them
/// apart.
/// @param samples  the first ones, with times in the file's unit
ClockGuess guessClock(const std::vector<GazeSample>& samples);

/// Adds the assumption, and what may be wrong with it.
void stateClockGuess(const ClockGuess& guess, TraceHeader& header);

}  // namespace foci
