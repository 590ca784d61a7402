// Timing things against each other: repeated, and in turn, so that whatever else the machine does
// meets all of them alike.
#pragma once

#include <functional>
#include <vector>

namespace foci {

struct TimedRun {
  std::function<double()> run_ms;  ///< does it once; returns how long it took
  int runs = 1;                    ///< > 0
  std::vector<double> ms = {};     ///< what they took
};

/// Runs everything once, in order, then everything that wants a second time, and so on.
void runInTurn(std::vector<TimedRun>& runs);

/// The middle one, or the mean of the two in the middle. Not empty.
double median(std::vector<double> values);

/// Numbers of threads to time at: one, and all that are allowed now.
std::vector<unsigned> threadCounts();

}  // namespace foci
