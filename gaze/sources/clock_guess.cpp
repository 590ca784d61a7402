#include "gaze/sources/clock_guess.h"

#include <algorithm>

#include "base/text.h"

namespace foci {
namespace {

constexpr double kSlow_Hz = 25.0;  // ten times as fast is the rate of most trackers

bool countsByOne(const std::vector<GazeSample>& samples) {
  const auto gap = std::adjacent_find(samples.begin(), samples.end(),
                                      [](const GazeSample& before, const GazeSample& after) {
                                        return after.time_s - before.time_s != 1.0;
                                      });
  return gap == samples.end() && samples.size() > 1 && samples.front().time_s <= 1.0;
}

}  // namespace

ClockGuess guessClock(const std::vector<GazeSample>& samples) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    intervals.push_back(samples[i].time_s - samples[i - 1].time_s);
  }
  if (intervals.empty()) return {};
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::nth_element(intervals.begin(), middle, intervals.end());
  for (const double scale_s : {1.0, 1e-3, 1e-6, 1e-9}) {
    const double rate_Hz = 1.0 / (*middle * scale_s);
    if (!(rate_Hz >= kMinRate_Hz && rate_Hz <= kMaxRate_Hz)) continue;
    return {.scale_s = scale_s,
            .counts_rows = scale_s == 1e-3 && countsByOne(samples),
            .may_be_ticks = scale_s == 1e-6 && rate_Hz < kSlow_Hz};
  }
  return {};
}

void stateClockGuess(const ClockGuess& guess, TraceHeader& header) {
  header.assumed.push_back("unit of time: " + exactText(guess.scale_s) +
                           " s, from the rate (gaze.time_scale_s)");
  if (guess.counts_rows) {
    header.warnings.push_back(
        "times count by one: foci takes them for milliseconds, but they may be row numbers; give "
        "gaze.time_scale_s or gaze.rate_Hz");
  }
  if (guess.may_be_ticks) {
    header.warnings.push_back(
        "times give fewer than 25 samples a second in microseconds: if they are ticks of 100 ns "
        "(.NET, Windows), give gaze.time_scale_s = 1e-7");
  }
}

}  // namespace foci
