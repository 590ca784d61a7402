#include "gaze/focus/vergence.h"

#include <cassert>
#include <cmath>
#include <numbers>
#include <utility>

namespace foci {

std::optional<DioptreEstimate> vergenceOf(const EyeRay& left, const EyeRay& right,
                                          double error_deg) {
  assert(error_deg > 0.0);
  constexpr double kMinBase_m = 0.01;
  if (!(glm::dot(left.direction, right.direction) > 0.5)) return std::nullopt;
  const glm::dvec3 mean = glm::normalize(left.direction + right.direction);
  const glm::dvec3 base = right.origin_m - left.origin_m;
  const glm::dvec3 across = base - glm::dot(base, mean) * mean;
  const double length_m = glm::length(across);
  if (!(length_m >= kMinBase_m)) return std::nullopt;
  const glm::dvec3 disparity = left.direction / glm::dot(left.direction, mean) -
                               right.direction / glm::dot(right.direction, mean);
  return DioptreEstimate{.value_D = glm::dot(disparity, across) / (length_m * length_m),
                         .error_D = std::numbers::sqrt2 * glm::radians(error_deg) / length_m};
}

std::optional<std::pair<EyeRay, EyeRay>> raysOf(const GazeSample& sample, const Screen& screen,
                                                double between_m) {
  std::pair<EyeRay, EyeRay> rays;
  for (std::size_t side : {0, 1}) {
    const EyeSample& eye = sample.eyes[side];
    EyeRay& ray = side == 0 ? rays.first : rays.second;
    if (eye.origin_m && eye.direction) {
      ray = {.origin_m = *eye.origin_m, .direction = *eye.direction};
    } else if (eye.point_px) {
      const glm::dvec2 offset_m =
          (*eye.point_px / glm::dvec2(screen.size_px) - 0.5) * screen.size_m;
      ray.origin_m = {side == 0 ? -0.5 * between_m : 0.5 * between_m, 0.0, 0.0};
      ray.direction =
          glm::normalize(glm::dvec3(offset_m.x, -offset_m.y, -screen.distance_m) - ray.origin_m);
    } else {
      return std::nullopt;
    }
  }
  return rays;
}

DioptreEstimate combined(std::span<const DioptreEstimate> estimates) {
  assert(!estimates.empty());
  double weights = 0.0, sum = 0.0;
  for (const DioptreEstimate& estimate : estimates) {
    const double weight = 1.0 / (estimate.error_D * estimate.error_D);
    weights += weight;
    sum += weight * estimate.value_D;
  }
  return {.value_D = sum / weights, .error_D = 1.0 / std::sqrt(weights)};
}

}  // namespace foci
