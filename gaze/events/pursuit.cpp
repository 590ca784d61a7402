#include "gaze/events/pursuit.h"

#include <algorithm>
#include <cmath>

namespace foci {

double StableGaze::evidence(double noise_deg, const EventRules& rules) const {
  constexpr double kMinDuration_s = 0.03;  // too short to tell
  if (duration_s() < kMinDuration_s) return -1.0;
  const double noise_deg2 = 2.0 * noise_deg * noise_deg;  // both axes
  // The variance of n samples (two axes) scatters by 1 / sqrt(n) of itself. The noise is known to a
  // seventh, so its square to a factor of 1.3.
  constexpr double kNoiseMargin = 1.3;
  const double margin = kNoiseMargin + 2.0 / std::sqrt(count());
  const double spread_deg = std::sqrt(std::max(variance_deg2() - margin * noise_deg2, 0.0));
  return rules.pursuit_bias + rules.pursuit_duration * std::log(duration_s()) +
         rules.pursuit_distance * std::log(distance_deg(noise_deg) + 0.1) +
         rules.pursuit_spread * std::log(spread_deg + 0.05);
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
