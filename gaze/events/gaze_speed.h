// The velocity of the line of sight, and its noise.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

namespace foci {

/// A sample as a direction. The direction is absent where the sample has no gaze.
struct TimedSight {
  double time_s = 0.0;
  std::optional<glm::dvec3> direction{};  ///< unit
};

/// Least-squares slope of the directions over time. It is exact for a steady turn much smaller than
/// a radian, and it does not depend on the place on the screen.
/// @return degrees of visual angle per second; nothing with fewer than two directions
std::optional<glm::dvec3> velocityOfSight_deg_s(std::span<const TimedSight> samples);

/// The velocity at a sample.
struct SightVelocity {
  glm::dvec3 deg_s{0.0};
  double speed_deg_s = 0.0;  ///< length of `deg_s`
  /// Noise relative to the noise of a complete window. It is above 1 beside data loss, where the
  /// window holds fewer samples.
  double noise_gain = 1.0;
};

/// The velocity at every sample that has a direction. Each window reaches half of `window_s` to
/// both sides, and at least to both neighbours. A window ends at a sample without a direction, and
/// at a step in time of more than `longest_step_s`.
std::vector<std::optional<SightVelocity>> velocitiesOfSight(std::span<const TimedSight> samples,
                                                            double window_s, double longest_step_s);

}  // namespace foci
