#include "gaze/geometry/cyclopean.h"

#include <cmath>

namespace foci {

std::optional<glm::dvec2> Cyclopean::combine(double time_s,
                                             const std::optional<glm::dvec2>& left_px,
                                             const std::optional<glm::dvec2>& right_px) {
  constexpr double kMemory_s = 0.3;  // chosen by eye: vergence hardly changes within a fixation
  if (left_px && right_px) {
    const glm::dvec2 half = 0.5 * (*right_px - *left_px);
    const double keep = half_px_ ? std::exp(-(time_s - time_s_) / kMemory_s) : 0.0;
    half_px_ = half_px_ ? glm::mix(half, *half_px_, keep) : half;
    time_s_ = time_s;
    return 0.5 * (*left_px + *right_px);
  }
  const glm::dvec2 half = half_px_.value_or(glm::dvec2(0.0));
  if (left_px) return *left_px + half;
  if (right_px) return *right_px - half;
  return std::nullopt;
}

}  // namespace foci
