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

/// Apertures of consecutive timed frames differ by this share, so that no method can reuse its
/// previous frame. Chosen by eye: too small to change the time. None is larger than the one that
/// errors are measured with: it might ask `auto` for a better quality level.
inline constexpr double kAperturesApart = 1e-3;

/// The first frame of a method finds cold buffers, so its time does not count. It counts if it
/// takes this many times as long as all timed frames may. Chosen by eye: such a method is timed
/// once.
inline constexpr double kSlowFirst = 4.0;

/// The middle value, or the mean of the two middle ones. @param values  not empty (asserted)
double median(std::vector<double> values);

/// Numbers of threads to measure times with: one, and as many as TBB may use now.
std::vector<unsigned> threadCounts();

}  // namespace foci
