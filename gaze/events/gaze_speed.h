// How fast the line of sight turns, and how much of that is noise.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

namespace foci {

/// A sample as a direction; absent where gaze is.
struct TimedSight {
  double time_s = 0.0;
  std::optional<glm::dvec3> direction{};  ///< unit
};

/// Least-squares slope of the directions over time: exact for a constant turn that is small against
/// a radian, and the same all over the screen.
/// @return degrees of visual angle a second; nothing with fewer than two directions
std::optional<glm::dvec3> velocityOfSight_deg_s(std::span<const TimedSight> samples);

/// The slope at a sample; `speed` is its length.
struct SightVelocity {
  glm::dvec3 deg_s{0.0};
  double speed_deg_s = 0.0;
  double noise_gain = 1.0;  ///< its noise, to that of a whole window; above 1 next to a loss
};

/// The slope at every sample that has a direction, over the samples up to half a window away on
/// both sides, and its neighbours even where they come late. Nothing is bridged: a window ends at a
/// sample without a direction, and at a step in time of more than `longest_step_s`.
std::vector<std::optional<SightVelocity>> velocitiesOfSight(std::span<const TimedSight> samples,
                                                            double window_s, double longest_step_s);

/// Standard deviation along each axis of the velocities' noise, from the median change of the
/// velocity from one window to the next: steady pursuit does not raise it, and saccades hardly do.
/// @param step  samples from one window to the next that shares none with it, >= 1
/// @return 0 with fewer than eight changes
double velocityNoise_deg_s(std::span<const std::optional<SightVelocity>> velocities,
                           std::size_t step);

}  // namespace foci
