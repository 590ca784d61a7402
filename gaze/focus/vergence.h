// How far away the two lines of sight meet, with its error, and estimates put together.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <span>

#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// A distance as its reciprocal.
struct DioptreEstimate {
  double value_D = 0.0;  ///< of a vergence below 0 where the lines of sight diverge
  double error_D = 0.0;  ///< standard deviation, > 0
};

/// Where one eye looks from and to.
struct EyeRay {
  glm::dvec3 origin_m{0.0};
  glm::dvec3 direction{0.0, 0.0, -1.0};  ///< unit
};

/// The reciprocal of the depth, along the mean direction m from between the eyes, at which the two
/// lines of sight have no disparity left:
///   V = (d_l / d_l.m - d_r / d_r.m) . b / b.b,   b the part of (o_r - o_l) across m.
/// Finite where the lines are parallel. Its error is that of the two directions, sqrt(2) sigma /
/// |b|: 0.2 D for half a degree and 63 mm, whatever the distance.
/// @param error_deg  standard deviation of each direction, > 0
/// @return nothing where the eyes have less than a centimetre between them, seen along m, or the
///   directions differ by 60 degrees or more
std::optional<DioptreEstimate> vergenceOf(const EyeRay& left, const EyeRay& right,
                                          double error_deg);

/// The two lines of sight of a sample: the recording's own, else from eyes `between_m` apart, side
/// by side in front of the screen, to their points on it. Nothing where an eye is missing.
std::optional<std::pair<EyeRay, EyeRay>> raysOf(const GazeSample& sample, const Screen& screen,
                                                double between_m);

/// The mean of independent estimates, weighted by the reciprocals of their variances, and its
/// error. @param estimates  one or more
DioptreEstimate combined(std::span<const DioptreEstimate> estimates);

}  // namespace foci
