// The constants were fitted together with those of saccades.cpp, on the same labelled recordings.

#include "gaze/events/gaze_speed.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "base/quantile.h"

namespace foci {
namespace {

/// Slopes over windows that move forward over samples with a direction. The sums behind a slope
/// change by the samples that enter and leave. They are relative to a sample nearby, and begin
/// anew every `kRenew` samples, so that rounding stays below 1e-7 deg/s.
class MovingSlope {
 public:
  MovingSlope(std::span<const TimedSight> samples, std::size_t begin)
      : samples_(samples), origin_(begin), first_(begin), end_(begin) {}

  /// The slope over the samples first to last, two or more.
  glm::dvec3 over_deg_s(std::size_t first, std::size_t last) {
    constexpr std::size_t kRenew = 64;
    if (first >= origin_ + kRenew) {
      *this = MovingSlope(samples_, first);
    }
    for (; end_ <= last; ++end_) count(end_, 1.0);
    for (; first_ < first; ++first_) count(first_, -1.0);
    return glm::degrees(1.0) / (count_ * squares_s2_ - time_s_ * time_s_) *
           (count_ * products_ - time_s_ * moved_);
  }

 private:
  void count(std::size_t i, double sign) {
    const double offset_s = samples_[i].time_s - samples_[origin_].time_s;
    const glm::dvec3 offset = *samples_[i].direction - *samples_[origin_].direction;
    count_ += sign;
    time_s_ += sign * offset_s;
    squares_s2_ += sign * offset_s * offset_s;
    moved_ += sign * offset;
    products_ += sign * offset_s * offset;
  }

  std::span<const TimedSight> samples_;
  std::size_t origin_, first_, end_;
  double count_ = 0.0, time_s_ = 0.0, squares_s2_ = 0.0;
  glm::dvec3 moved_{0.0}, products_{0.0};
};

double angle_deg(const glm::dvec3& a, const glm::dvec3& b) {
  return glm::degrees(glm::distance(a, b));
}

/// Samples from a window to the next one that does not overlap it.
std::size_t stepOf(double window_s, double rate_Hz) {
  return static_cast<std::size_t>(window_s * rate_Hz + 1.01);
}

}  // namespace

std::optional<glm::dvec3> velocityOfSight_deg_s(std::span<const TimedSight> samples) {
  double count = 0.0, mean_s = 0.0;
  glm::dvec3 mean{0.0};
  for (const TimedSight& sample : samples) {
    if (!sample.direction) continue;
    count += 1.0;
    mean_s += sample.time_s;
    mean += *sample.direction;
  }
  if (count < 2.0) return std::nullopt;
  mean_s /= count;
  mean /= count;
  double squares_s2 = 0.0;
  glm::dvec3 products{0.0};
  for (const TimedSight& sample : samples) {
    if (!sample.direction) continue;
    const double offset_s = sample.time_s - mean_s;
    squares_s2 += offset_s * offset_s;
    products += offset_s * (*sample.direction - mean);
  }
  return glm::degrees(products / squares_s2);
}

std::vector<std::optional<SightVelocity>> velocitiesOfSight(std::span<const TimedSight> samples,
                                                            double window_s,
                                                            double longest_step_s) {
  constexpr double kRounding_s = 1e-6;
  const double reach_s = 0.5 * window_s + kRounding_s;
  std::vector<std::optional<SightVelocity>> velocities(samples.size());
  const auto joined = [&](std::size_t i) {  // sample i continues sample i - 1
    return samples[i].direction && samples[i - 1].direction &&
           samples[i].time_s - samples[i - 1].time_s <= longest_step_s;
  };
  for (std::size_t begin = 0; begin < samples.size();) {
    std::size_t end = begin + 1;
    if (!samples[begin].direction) {
      begin = end;
      continue;
    }
    while (end < samples.size() && joined(end)) ++end;
    MovingSlope slope(samples, begin);
    std::size_t first = begin, last = begin;
    for (std::size_t i = begin; i < end; ++i) {
      while (first + 1 < i && samples[i].time_s - samples[first].time_s > reach_s) ++first;
      while (last + 1 < end &&
             (last <= i || samples[last + 1].time_s - samples[i].time_s <= reach_s)) {
        ++last;
      }
      if (first == last) continue;
      const glm::dvec3 deg_s = slope.over_deg_s(first, last);
      // The variance of a slope over n equal steps falls with n^3.
      const double complete = static_cast<double>(2 * std::max(i - first, last - i) + 1);
      const double share = static_cast<double>(last - first + 1) / complete;
      velocities[i] = {.deg_s = deg_s,
                       .speed_deg_s = glm::length(deg_s),
                       .noise_gain = share == 1.0 ? 1.0 : 1.0 / (share * std::sqrt(share))};
    }
    begin = end;
  }
  return velocities;
}

double longestStep_s(double rate_Hz) { return 2.5 / rate_Hz; }

double scaleWindow_s(std::size_t scale, double rate_Hz, const EventSettings& settings) {
  return std::max(settings.window_s, 2.0 / rate_Hz) * std::exp2(static_cast<double>(scale));
}

bool mayHideSaccades(double noise_deg_s, std::size_t scale, double rate_Hz,
                     const EventSettings& settings) {
  const EventRules& rules = settings.rules;
  const bool narrow = scale == 0 && scaleWindow_s(0, rate_Hz, settings) <= kWide_s;
  return rules.hidden_noise * noise_deg_s > (narrow ? settings.saccade_deg_s : kWidePeak_deg_s) ||
         (narrow && rules.peak_noise * noise_deg_s > kBlurredPeak_deg_s);
}

RecentNoise::RecentNoise(double rate_Hz, const EventSettings& settings)
    : rate_Hz_(rate_Hz),
      settings_(settings),
      span_(std::max<std::size_t>(static_cast<std::size_t>(settings.rules.noise_span_s * rate_Hz),
                                  1)) {
  const auto changesOver = [&](double window_s) {
    return Changes{.window_s = window_s, .step = stepOf(window_s, rate_Hz)};
  };
  of_samples_ = changesOver(2.0 / rate_Hz);
  for (std::size_t scale = 0; scale < kNoiseScales; ++scale) {
    of_scales_.push_back(changesOver(scaleWindow_s(scale, rate_Hz, settings)));
  }
}

void RecentNoise::push(const TimedSight& sight) {
  if (sights_.empty()) begin_s_ = sight.time_s;
  // Remove the older half in one step, so that the mean cost per sample stays constant.
  const std::size_t kept = span_ + static_cast<std::size_t>(3.0 * kMaxNoiseWindow_s * rate_Hz_) + 8;
  if (sights_.size() >= 2 * kept) {
    sights_.erase(sights_.begin(), sights_.end() - static_cast<std::ptrdiff_t>(kept));
    dropped_ += kept;
  }
  sights_.push_back(sight);
}

bool RecentNoise::update() {
  constexpr double kAgain_s = 0.25;  // the noise changes slowly
  const double time_s = sights_.back().time_s;
  const bool is_first = noise_.velocity_deg_s.empty();
  if (!is_first && time_s - measured_s_ < std::min(kAgain_s, 0.3 * (time_s - begin_s_))) {
    return false;
  }
  measured_s_ = time_s;
  // The slope over three samples is half the difference of the outer two, divided by the interval.
  noise_ = {.sample_deg = measured_deg_s(of_samples_, 0.0) * std::sqrt(2.0) / rate_Hz_};
  bool wider = true;
  for (std::size_t scale = 0; scale < kNoiseScales; ++scale) {
    Changes& changes = of_scales_[scale];
    wider = wider && (scale == 0 || (changes.window_s <= kMaxNoiseWindow_s &&
                                     mayHideSaccades(noise_.velocity_deg_s.back(), scale - 1,
                                                     rate_Hz_, settings_)));
    noise_.velocity_deg_s.push_back(wider ? measured_deg_s(changes, settings_.rules.noise_errors)
                                          : noise_.velocity_deg_s.back());
  }
  return true;
}

/// Adds the samples whose windows are complete by now.
void RecentNoise::extend(Changes& changes) {
  const double reach_s = 0.5 * changes.window_s;
  std::size_t end = sights_.size();  // index in `sights_`, as all below
  while (end > 0 && sights_.back().time_s - sights_[end - 1].time_s < reach_s) --end;
  if (changes.end < dropped_) {
    changes.end = dropped_;
    changes.deg_s.clear();
  }
  const std::size_t begin = changes.end - dropped_;
  if (begin >= end) return;
  const std::size_t before = begin - std::min(begin, changes.step);
  std::size_t from = before;
  while (from > 0 && sights_[before].time_s - sights_[from].time_s <= reach_s) --from;
  const auto velocities = velocitiesOfSight(std::span(sights_).subspan(from), changes.window_s,
                                            longestStep_s(rate_Hz_));
  if (changes.deg_s.size() >= 2 * span_) {
    changes.deg_s.erase(changes.deg_s.begin(),
                        changes.deg_s.end() - static_cast<std::ptrdiff_t>(span_));
  }
  for (std::size_t i = begin; i < end; ++i) {
    const bool known =
        i >= from + changes.step && velocities[i - from] && velocities[i - from - changes.step];
    changes.deg_s.push_back(
        known ? static_cast<float>(glm::distance(velocities[i - from]->deg_s,
                                                 velocities[i - from - changes.step]->deg_s))
              : -1.0F);
  }
  changes.end = dropped_ + end;
}

double RecentNoise::measured_deg_s(Changes& changes, double errors) {
  constexpr std::size_t kMinChanges = 8;
  extend(changes);
  sorted_.clear();
  const std::size_t count = std::min(span_, changes.deg_s.size());
  std::copy_if(changes.deg_s.end() - static_cast<std::ptrdiff_t>(count), changes.deg_s.end(),
               std::back_inserter(sorted_),
               [](float change_deg_s) { return change_deg_s >= 0.0F; });
  if (sorted_.size() < kMinChanges) return 0.0;
  const auto median = static_cast<double>(quantile(sorted_, 0.5));
  // The standard error of the median of n values of a Rayleigh distribution is 0.72 / sqrt(n) of
  // it. Only windows that do not overlap are independent.
  constexpr double kErrorOfMedian = 0.72;
  const double windows = static_cast<double>(sorted_.size()) / static_cast<double>(changes.step);
  const double upper = 1.0 + errors * kErrorOfMedian / std::sqrt(std::max(windows, 1.0));
  // The median of a Rayleigh distribution is sqrt(2 ln 2) times sigma. A difference of two
  // velocities has twice the variance.
  return upper * median / (std::sqrt(2.0 * std::numbers::ln2) * std::numbers::sqrt2);
}

std::vector<TimedSight> withoutSpikes(std::span<const TimedSight> sights, double rate_Hz,
                                      const SightNoise& noise) {
  constexpr double kMaxSpike_s = 0.025;
  constexpr double kMinRate_Hz = 60.0;  // at lower rates one sample may be a fixation
  constexpr double kMinSpike_deg = 0.5, kMinSpikeNoise = 8.0;
  constexpr double kReturns =
      4.0;  // a spike is this much farther than the step between its neighbours
  std::vector<TimedSight> result(sights.begin(), sights.end());
  if (rate_Hz < kMinRate_Hz) return result;
  const double min_deg = std::max(kMinSpike_deg, kMinSpikeNoise * noise.sample_deg);
  // From its neighbour before, a spike is at least this part of its own size away.
  const double min_step_deg = (1.0 - 0.5 / kReturns) * min_deg;
  for (std::size_t i = 1; i < result.size(); ++i) {
    if (!result[i].direction || !result[i - 1].direction ||
        angle_deg(*result[i].direction, *result[i - 1].direction) <= min_step_deg) {
      continue;
    }
    for (std::size_t length : {1, 2, 3}) {
      const std::size_t next = i + length;
      if (next >= result.size() || static_cast<double>(length + 1) > kMaxSpike_s * rate_Hz) break;
      if (!result[next].direction) continue;
      const glm::dvec3 from = *result[i - 1].direction, to = *result[next].direction;
      double out_deg = 180.0;
      for (std::size_t j = i; j < next; ++j) {
        if (!result[j].direction)
          out_deg = 0.0;
        else
          out_deg = std::min(out_deg, angle_deg(*result[j].direction, 0.5 * (from + to)));
      }
      if (out_deg <= min_deg || out_deg <= kReturns * angle_deg(from, to)) continue;
      for (std::size_t j = i; j < next; ++j) {
        const double part = static_cast<double>(j + 1 - i) / static_cast<double>(length + 1);
        result[j].direction = glm::normalize(glm::mix(from, to, part));
      }
    }
  }
  return result;
}

}  // namespace foci
