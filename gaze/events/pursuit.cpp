#include "gaze/events/pursuit.h"

#include <algorithm>
#include <cmath>

namespace foci {

void StableGaze::add(double time_s, const glm::dvec3& direction) {
  if (count_ == 0.0) {
    first_s_ = time_s;
    first_ = direction;
  }
  newest_s_ = time_s;
  newest_ = direction;
  count_ += 1.0;
  const double since_s = time_s - first_s_ - mean_s_;
  mean_s_ += since_s / count_;
  squares_s2_ += since_s * (time_s - first_s_ - mean_s_);
  const glm::dvec3 before = direction - mean_;
  mean_ += before / count_;
  products_ += since_s * (direction - mean_);
  squares_ += glm::dot(before, direction - mean_);
}

double StableGaze::evidence(double noise_deg, const EventRules& rules) const {
  constexpr double kMinDuration_s = 0.03;  // too short to tell
  const double duration_s = newest_s_ - first_s_;
  if (duration_s < kMinDuration_s) return -1.0;
  const double noise_deg2 = 2.0 * noise_deg * noise_deg;  // both axes
  const double distance_deg = glm::degrees(glm::distance(first_, newest_));
  const double spread_deg2 = std::pow(glm::degrees(1.0), 2) * squares_ / count_;
  // The squared distance between two noisy samples is chi-square distributed (two axes): 95 % of
  // its values are below three times its mean, which is 2 noise_deg2.
  constexpr double kDistance95 = 3.0;
  // The variance of n samples (two axes) scatters by 1 / sqrt(n) of itself. The noise is known to a
  // seventh, so its square to a factor of 1.3.
  constexpr double kNoiseMargin = 1.3;
  const double distance =
      std::sqrt(std::max(distance_deg * distance_deg - kDistance95 * 2.0 * noise_deg2, 0.0));
  const double spread =
      std::sqrt(std::max(spread_deg2 - (kNoiseMargin + 2.0 / std::sqrt(count_)) * noise_deg2, 0.0));
  return rules.pursuit_bias + rules.pursuit_duration * std::log(duration_s) +
         rules.pursuit_distance * std::log(distance + 0.1) +
         rules.pursuit_spread * std::log(spread + 0.05);
}

glm::dvec3 StableGaze::velocity_deg_s() const {
  return squares_s2_ > 0.0 ? glm::degrees(1.0) / squares_s2_ * products_ : glm::dvec3(0.0);
}

double StableGaze::variance_deg2_s2(double noise_deg) const {
  return squares_s2_ > 0.0 ? noise_deg * noise_deg / squares_s2_ : 0.0;
}

double StableGaze::agreement(const StableGaze& other, double noise_deg, double still_deg_s) const {
  const glm::dvec3 u = velocity_deg_s(), v = other.velocity_deg_s();
  return glm::dot(u, v) / (glm::length(u) * glm::length(v) + still_deg_s * still_deg_s +
                           variance_deg2_s2(noise_deg) + other.variance_deg2_s2(noise_deg));
}

bool StableGaze::isPursuit(double noise_deg, const EventRules& rules, const StableGaze* before,
                           const StableGaze* after) const {
  double sum = evidence(noise_deg, rules);
  for (const StableGaze* neighbour : {before, after}) {
    if (!neighbour) continue;
    sum += rules.pursuit_neighbour * agreement(*neighbour, noise_deg, rules.pursuit_still_deg_s);
  }
  return sum > 0.0;
}

}  // namespace foci
