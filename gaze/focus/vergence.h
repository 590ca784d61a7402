// Vergence: how far away the two lines of sight meet. Also the combination of estimates of
// distance.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <utility>

#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// The reciprocal of a distance, with its error.
struct DioptreEstimate {
  double value_D = 0.0;  ///< a vergence is below 0 if the lines of sight diverge
  double error_D = 0.0;  ///< standard deviation, > 0
};

/// The line of sight of one eye.
struct EyeRay {
  glm::dvec3 origin_m{0.0};
  glm::dvec3 direction{0.0, 0.0, -1.0};  ///< unit
};

/// The vergence V of two lines of sight: the reciprocal of the depth at which they have no
/// disparity. Depth is measured along their mean direction m. With the part b of (o_r - o_l)
/// perpendicular to m,
///   V = (d_l / d_l.m - d_r / d_r.m) . b / b.b.
/// V is 0 for parallel lines of sight and negative if they diverge.
/// @return dioptres; nothing if |b| is below a centimetre, or if the directions differ by 60
///   degrees or more
std::optional<double> vergence_D(const EyeRay& left, const EyeRay& right);

/// `vergence_D` and its error, sqrt(2) sigma / |b|. The error does not depend on the distance: it
/// is 0.2 D for half a degree and an interpupillary distance of 63 mm.
/// @param error_deg  sigma, the standard deviation of each direction, > 0
std::optional<DioptreEstimate> vergenceOf(const EyeRay& left, const EyeRay& right,
                                          double error_deg);

/// The two lines of sight of a sample. If the recording has points on the screen only, or
/// directions without origins, the eyes are `ipd_m` apart, side by side. Nothing if an eye is
/// missing.
std::optional<std::pair<EyeRay, EyeRay>> raysOf(const GazeSample& sample, const Screen& screen,
                                                double ipd_m);

/// The mean of independent estimates, weighted by the reciprocals of their variances, and its
/// error.
/// @param estimates  one or more
DioptreEstimate combined(std::span<const DioptreEstimate> estimates);

}  // namespace foci
