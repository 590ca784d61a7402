#include "gaze/events/gaze_speed.h"

namespace foci {

std::optional<double> speedOfSight_deg_s(std::span<const TimedSight> samples) {
  double count = 0.0, mean_s = 0.0;
  glm::dvec3 mean{0.0};
  for (const TimedSight& sample : samples) {
    if (!sample.direction) continue;
    count += 1.0;
    mean_s += (sample.time_s - mean_s) / count;
    mean += (*sample.direction - mean) / count;
  }
  if (count < 2.0) return std::nullopt;
  double squares_s2 = 0.0;
  glm::dvec3 products{0.0};
  for (const TimedSight& sample : samples) {
    if (!sample.direction) continue;
    const double offset_s = sample.time_s - mean_s;
    squares_s2 += offset_s * offset_s;
    products += offset_s * (*sample.direction - mean);
  }
  return glm::degrees(glm::length(products) / squares_s2);
}

}  // namespace foci
