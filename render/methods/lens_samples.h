// Points on the lens.
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <numbers>

namespace foci {

/// Sample `i` of `n` on the unit disc, stratified: Vogel's spiral, equal areas at the golden angle.
/// Every other one is again stratified.
inline glm::vec2 lensSample(int i, int n) {
  const double golden_angle_rad = std::numbers::pi * (3.0 - std::sqrt(5.0));
  const double radius = std::sqrt((i + 0.5) / n), angle_rad = i * golden_angle_rad;
  return {static_cast<float>(radius * std::cos(angle_rad)),
          static_cast<float>(radius * std::sin(angle_rad))};
}

}  // namespace foci
