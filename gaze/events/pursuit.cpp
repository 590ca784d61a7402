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
  const glm::dvec3 before = direction - mean_;
  mean_ += before / count_;
  squares_ += glm::dot(before, direction - mean_);
}

bool StableGaze::isPursuit(double noise_deg) const {
  constexpr double kShortest_s = 0.03;  // nothing can be said of less
  const double duration_s = newest_s_ - first_s_;
  if (duration_s < kShortest_s) return false;
  const double noise_deg2 = 2.0 * noise_deg * noise_deg;  // of two axes
  const double way_deg = glm::degrees(glm::distance(first_, newest_));
  const double spread_deg2 = std::pow(glm::degrees(1.0), 2) * squares_ / count_;
  const double way = std::sqrt(std::max(way_deg * way_deg - 2.0 * noise_deg2, 0.0));
  const double spread = std::sqrt(std::max(spread_deg2 - noise_deg2, 0.0));
  return 0.37 - 0.39 * std::log(duration_s) + 1.59 * std::log(way + 0.1) +
             1.20 * std::log(spread + 0.05) >
         0.0;
}

}  // namespace foci
