// The unit of time of a table that does not state it.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "base/quantile.h"
#include "base/text.h"
#include "gaze/sources/row_times.h"

namespace foci {
namespace {

// Slower ones are not read without a word; only few trackers are faster.
constexpr double kMinUsual_Hz = 20.0, kMaxUsual_Hz = 2000.0;
constexpr std::array kUsualRates_Hz = {
    30.0,  50.0,  60.0,  72.0,  75.0,  90.0,  100.0, 120.0, 125.0, 150.0,  200.0,  220.0,  240.0,
    250.0, 300.0, 350.0, 360.0, 400.0, 500.0, 600.0, 800.0, 900.0, 1000.0, 1200.0, 1250.0, 2000.0};
constexpr double kRateSlack = 0.02;

constexpr double kMinFixation_s = 0.1, kMaxFixation_s = 1.5;  // usual ones

bool isUsualRate(double rate_Hz) {
  return std::ranges::any_of(kUsualRates_Hz, [&](double usual_Hz) {
    return std::abs(rate_Hz - usual_Hz) <= kRateSlack * usual_Hz;
  });
}

bool isWhole(const std::vector<GazeSample>& samples) {
  return std::ranges::all_of(
      samples, [](const GazeSample& sample) { return sample.time_s == std::floor(sample.time_s); });
}

bool countsByOne(const std::vector<GazeSample>& samples) {
  const auto gap =
      std::ranges::adjacent_find(samples, [](const GazeSample& before, const GazeSample& after) {
        return after.time_s - before.time_s != 1.0;
      });
  return gap == samples.end() && samples.size() > 1;
}

/// The unit of a time that counts from a known day: with it, the day lies in this century.
/// @param interval  between samples, in the same unit
std::optional<double> unitOfDate(double time, double interval) {
  constexpr double kFrom_s = 946'684'800.0, kCentury_s = 3'155'760'000.0;    // 2000, after 1970
  constexpr double k1601_s = 11'644'473'600.0, kYear1_s = 62'135'596'800.0;  // before 1970
  const auto isNow = [&](double time_s) {
    return time_s >= kFrom_s && time_s < kFrom_s + kCentury_s;
  };
  const auto fits = [&](double scale_s) {
    const double rate_Hz = 1.0 / (scale_s * interval);
    return rate_Hz >= kMinRate_Hz && rate_Hz <= kMaxRate_Hz;
  };
  for (const double scale_s : {1.0, 1e-3, 1e-6, 1e-7, 1e-9}) {
    if (fits(scale_s) && isNow(scale_s * time)) return scale_s;
  }
  const bool ticks_of_date = isNow(1e-7 * time - k1601_s) || isNow(1e-7 * time - kYear1_s);
  const bool has_17_or_18_digits = time >= 1e16 && time < 1e18;
  if (fits(1e-7) && (ticks_of_date || has_17_or_18_digits)) return 1e-7;
  return std::nullopt;
}

std::optional<glm::dvec3> placeOf(const GazeSample& sample) {
  if (sample.direction) return sample.direction;
  if (sample.point_px) return glm::dvec3(*sample.point_px, 0.0);
  for (const EyeSample& eye : sample.eyes) {
    if (eye.point_px) return glm::dvec3(*eye.point_px, 0.0);
    if (eye.direction) return eye.direction;
  }
  return std::nullopt;
}

/// Samples between two saccades, as the mean; nothing if there are too few. A saccade is a run of
/// steps that are far longer than the usual one.
std::optional<double> samplesOfFixation(const std::vector<GazeSample>& samples) {
  constexpr std::size_t kMinSaccades = 3;
  constexpr double kLong = 12.0;  // times the median step
  std::vector<double> steps;
  std::optional<glm::dvec3> before;
  for (const GazeSample& sample : samples) {
    const auto place = placeOf(sample);
    if (place && before) steps.push_back(glm::distance(*place, *before));
    before = place;
  }
  if (steps.size() < 16) return std::nullopt;
  std::vector<double> sorted = steps;
  const double longest = *std::ranges::max_element(steps);
  const double limit = std::max(kLong * quantile(sorted, 0.5), 0.1 * longest);
  std::size_t saccades = 0;
  bool inside = false;
  for (const double step : steps) {
    saccades += step > limit && !inside;
    inside = step > limit;
  }
  if (saccades < kMinSaccades) return std::nullopt;
  return static_cast<double>(steps.size()) / static_cast<double>(saccades + 1);
}

constexpr double kShortest_s = 0.05, kLongest_s = 3.0;  // beyond doubt no fixations

bool isFixation(double samples, double interval_s) {
  return samples * interval_s >= kMinFixation_s && samples * interval_s <= kMaxFixation_s;
}

/// The only unit that gives the rate of a tracker. A counter's ticks of any other length give an
/// odd rate, or fixations of an odd duration.
ClockGuess onlyUnit(double scale_s, double interval, const std::optional<double>& dwell,
                    const std::vector<GazeSample>& samples) {
  ClockGuess guess{.scale_s = scale_s};
  const double mean =
      (samples.back().time_s - samples.front().time_s) / static_cast<double>(samples.size() - 1);
  const double fixation_s = dwell ? *dwell * interval * scale_s : 0.0;
  const std::string unit = exactText(scale_s) + " s a unit of time";
  if (interval * scale_s * kMaxUsual_Hz < 1.0 - kRateSlack) return guess;  // doubted for all units
  const bool ticks = scale_s > 1.0 || scale_s == 1e-4 || scale_s == 1e-7;
  if (ticks && !(dwell && isFixation(*dwell, interval * scale_s))) {
    guess.is_open = !dwell;
    guess.doubt = "the times may be in units of " + exactText(scale_s) + " s, by the rate of " +
                  significant(1.0 / (scale_s * interval)) +
                  " Hz alone: if that is wrong, give gaze.time_scale_s";
    return guess;
  }
  if (!isUsualRate(1.0 / (scale_s * interval)) && !isUsualRate(1.0 / (scale_s * mean))) {
    guess.doubt = "with " + unit + ", the rate is " + significant(1.0 / (scale_s * interval)) +
                  " Hz, which is no tracker's usual one: if that is wrong, give gaze.time_scale_s";
  } else if (dwell && (fixation_s < kShortest_s || fixation_s > kLongest_s)) {
    guess.doubt = "with " + unit + ", fixations last " + significant(fixation_s, 2) +
                  " s, which is not usual: if that is wrong, give gaze.time_scale_s";
  }
  return guess;
}

ClockGuess guessOfInterval(double interval, bool whole, const std::vector<GazeSample>& samples) {
  const auto rateOf = [&](double scale_s) { return 1.0 / (interval * scale_s); };
  const auto unitName = [](double scale_s) { return exactText(scale_s) + " s"; };
  std::vector<double> units;  // that give the rate of a tracker
  for (const double scale_s : {1.0, 1e-3, 1e-6, 1e-9}) {
    const double rate_Hz = rateOf(scale_s);
    if (rate_Hz >= kMinUsual_Hz && rate_Hz <= (1.0 + kRateSlack) * kMaxUsual_Hz) {
      units.push_back(scale_s);
    }
  }
  for (const double scale_s : {60.0, 1e-4, 1e-7}) {
    const bool counted = scale_s == 60.0 || whole;  // nobody writes fractions of ticks
    if (counted && isUsualRate(rateOf(scale_s))) units.push_back(scale_s);
  }
  if (units.empty()) {
    for (const double scale_s : {1.0, 1e-3, 1e-6, 1e-9}) {
      const double rate_Hz = rateOf(scale_s);
      if (rate_Hz < kMinRate_Hz || rate_Hz > kMaxRate_Hz) continue;
      return onlyUnit(scale_s, interval, std::nullopt, samples);
    }
    return {};
  }
  const auto dwell = samplesOfFixation(samples);
  if (units.size() == 1) return onlyUnit(units[0], interval, dwell, samples);
  const std::string both = "times may be in " + unitName(units[0]) + " (" +
                           significant(rateOf(units[0])) + " Hz) or in " + unitName(units[1]) +
                           " (" + significant(rateOf(units[1])) + " Hz): give gaze.time_scale_s";
  if (dwell) {
    std::vector<double> likely, possible;
    for (const double unit : units) {
      const double fixation_s = *dwell * interval * unit;
      if (isFixation(*dwell, interval * unit)) likely.push_back(unit);
      if (fixation_s > kShortest_s && fixation_s < kLongest_s) possible.push_back(unit);
    }
    if (likely.size() == 1) {
      return {.scale_s = likely[0],
              .why = "the usual duration of fixations, " +
                     significant(*dwell * interval * likely[0], 2) + " s",
              .doubt = possible.size() > 1 ? both : ""};
    }
  }
  if (units[1] == 1e-4) return {.scale_s = units[0], .doubt = both, .is_open = true};
  return {.refusal = both, .is_open = true};
}

}  // namespace

ClockGuess guessClock(const std::vector<GazeSample>& samples, std::optional<double> rate_Hz) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const double interval = samples[i].time_s - samples[i - 1].time_s;
    if (interval > 0.0) intervals.push_back(interval);
  }
  if (intervals.empty()) return {};
  const double interval = quantile(intervals, 0.5);
  for (const double scale_s : {60.0, 1.0, 1e-3, 1e-4, 1e-6, 1e-7, 1e-9}) {
    constexpr double kNear = 1.1;
    const double times = rate_Hz.value_or(0.0) * scale_s * interval;
    if (times < kNear && times > 1.0 / kNear) return {.scale_s = scale_s, .why = "the stated rate"};
  }
  if (const auto unit = unitOfDate(samples.front().time_s, interval)) {
    return {.scale_s = *unit, .why = "the rate and the size of the times"};
  }
  if (countsByOne(samples)) {
    const std::string rows = "times count by one";
    const auto dwell = samplesOfFixation(samples);
    if (dwell && !isFixation(*dwell, 1e-3)) {
      return {.refusal =
                  rows +
                  ", so they may be numbers of frames: as milliseconds, fixations would "
                  "last " +
                  significant(*dwell, 2) +
                  " ms; give gaze.rate_Hz, or gaze.time_scale_s, the seconds between two rows"};
    }
    const char* const doubt =
        ": foci takes them for milliseconds, but they may be row numbers; give "
        "gaze.time_scale_s or gaze.rate_Hz";
    const bool from_first = samples.front().time_s <= 1.0;
    return {.scale_s = 1e-3, .doubt = from_first ? rows + doubt : "", .is_open = !dwell};
  }
  return guessOfInterval(interval, isWhole(samples), samples);
}

}  // namespace foci
