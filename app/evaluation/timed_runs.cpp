#include "app/evaluation/timed_runs.h"

#include <algorithm>
#include <cassert>

#include "base/parallel.h"

namespace foci {

void runInTurn(std::vector<TimedRun>& runs) {
  int rounds = 0;
  for (const TimedRun& one : runs) rounds = std::max(rounds, one.runs);
  for (int round = 0; round < rounds; ++round) {
    for (TimedRun& one : runs) {
      if (round < one.runs) one.ms.push_back(one.run_ms());
    }
  }
}

double median(std::vector<double> values) {
  assert(!values.empty());
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return 0.5 * (values[(n - 1) / 2] + values[n / 2]);
}

std::vector<unsigned> threadCounts() {
  const unsigned all = maxThreads();
  return all > 1 ? std::vector<unsigned>{1, all} : std::vector<unsigned>{1};
}

}  // namespace foci
