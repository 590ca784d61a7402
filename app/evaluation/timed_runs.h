// Times of runs that take turns, so that other load on the machine slows all of them alike.
#pragma once

#include <functional>
#include <vector>

namespace foci {

struct TimedRun {
  std::function<double()> run_ms;  ///< runs once and returns its time
  int runs = 1;                    ///< number of runs, > 0
  std::vector<double> ms = {};     ///< their times
};

/// Runs every entry once, in order; then every entry that has runs left; until none has.
void runInTurn(std::vector<TimedRun>& runs);

/// The middle value, or the mean of the two middle ones. @param values  not empty (asserted)
double median(std::vector<double> values);

/// Numbers of threads to measure times with: one, and as many as TBB may use now.
std::vector<unsigned> threadCounts();

}  // namespace foci
