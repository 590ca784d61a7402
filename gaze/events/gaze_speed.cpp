#include "gaze/events/gaze_speed.h"

#include <algorithm>
#include <cmath>

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

}  // namespace foci
