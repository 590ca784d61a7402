#include "gaze/focus/vergence.h"

#include <cassert>
#include <cmath>
#include <numbers>

#include "gaze/geometry/line_of_sight.h"

namespace foci {

namespace {

/// The vector from the left eye to the right, without its part along the mean direction.
std::optional<glm::dvec3> baselineOf_m(const EyeRay& left, const EyeRay& right) {
  constexpr double kMinBaseline_m = 0.01;
  constexpr double kMinCosine = 0.5;  // 60 degrees between the lines of sight
  if (!(glm::dot(left.direction, right.direction) > kMinCosine)) return std::nullopt;
  const glm::dvec3 mean = glm::normalize(left.direction + right.direction);
  const glm::dvec3 between = right.origin_m - left.origin_m;
  const glm::dvec3 baseline = between - glm::dot(between, mean) * mean;
  return glm::length(baseline) >= kMinBaseline_m ? std::optional(baseline) : std::nullopt;
}

}  // namespace

std::optional<double> vergence_D(const EyeRay& left, const EyeRay& right) {
  const auto baseline = baselineOf_m(left, right);
  if (!baseline) return std::nullopt;
  const glm::dvec3 mean = glm::normalize(left.direction + right.direction);
  const glm::dvec3 disparity = left.direction / glm::dot(left.direction, mean) -
                               right.direction / glm::dot(right.direction, mean);
  const double length_m = glm::length(*baseline);
  return glm::dot(disparity, *baseline) / (length_m * length_m);
}

std::optional<DioptreEstimate> vergenceOf(const EyeRay& left, const EyeRay& right,
                                          double error_deg) {
  assert(error_deg > 0.0);
  const auto value_D = vergence_D(left, right);
  if (!value_D) return std::nullopt;
  const double baseline_m = glm::length(*baselineOf_m(left, right));
  return DioptreEstimate{.value_D = *value_D,
                         .error_D = std::numbers::sqrt2 * glm::radians(error_deg) / baseline_m};
}

std::optional<std::pair<EyeRay, EyeRay>> raysOf(const GazeSample& sample, const Screen& screen,
                                                double ipd_m) {
  std::pair<EyeRay, EyeRay> rays;
  for (std::size_t side : {0, 1}) {
    const EyeSample& eye = sample.eyes[side];
    EyeRay& ray = side == 0 ? rays.first : rays.second;
    const glm::dvec3 usual_m(side == 0 ? -0.5 * ipd_m : 0.5 * ipd_m, 0.0, 0.0);
    if (eye.origin_m && eye.direction) {
      ray = {.origin_m = *eye.origin_m, .direction = *eye.direction};
    } else if (eye.point_px) {
      const glm::dvec3 target_m(offsetOnScreen_m(screen, *eye.point_px), -screen.distance_m);
      ray = {.origin_m = usual_m, .direction = glm::normalize(target_m - usual_m)};
    } else if (eye.direction) {
      ray = {.origin_m = usual_m, .direction = *eye.direction};
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
