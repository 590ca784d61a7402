// How fast the line of sight turns.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <span>

namespace foci {

/// A sample as a direction; absent where gaze is.
struct TimedSight {
  double time_s = 0.0;
  std::optional<glm::dvec3> direction{};  ///< unit
};

/// Least-squares slope of the directions over time: exact for a constant turn that is small against
/// a radian, and the same all over the screen.
/// @return degrees of visual angle a second; nothing with fewer than two directions
std::optional<double> speedOfSight_deg_s(std::span<const TimedSight> samples);

}  // namespace foci
