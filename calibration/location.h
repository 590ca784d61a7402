// The centre of a cloud of samples of which some are outliers.
#pragma once

#include <span>

#include <glm/glm.hpp>

namespace foci {

struct RobustLocation {
  glm::dvec2 centre{0.0};
  glm::dvec2 sd{0.0};  ///< per axis, from the median absolute deviation; 0 for a single sample
};

/// Median of a Rayleigh distribution over its sigma, sqrt(2 ln 2): the length of an error with
/// Gaussian axes.
inline constexpr double kRayleighMedian = 1.1774;

/// Tukey's biweight around the median, scaled by the median absolute deviation. 10 % of outliers do
/// not move the result. `samples` must not be empty.
/// @param weights  one for each sample; empty: all are equal
RobustLocation robustLocation(std::span<const glm::dvec2> samples,
                              std::span<const double> weights = {});

}  // namespace foci
