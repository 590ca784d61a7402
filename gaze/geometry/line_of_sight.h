// Conversions between points on a flat screen and lines of sight.
//
// The eye frame is right-handed: x to the right, y up, and the eye looks along -z at the screen's
// faced point, which is its centre on a desk. Screen points are pixels from the top-left corner, y
// down. Each screen must have a known size and distance (asserted).
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// Metres from the faced point to a point in the screen's plane, x to the right, y up.
glm::dvec2 offsetOnScreen_m(const Screen& screen, const glm::dvec2& point_px);

/// Unit direction in the eye frame from the eye through a point in the screen's plane.
glm::dvec3 lineOfSight(const Screen& screen, const glm::dvec2& point_px);

/// The point where a direction meets the screen's plane; nothing if it leads away from the plane.
std::optional<glm::dvec2> pointOnScreen_px(const Screen& screen, const glm::dvec3& direction);

/// Angle at the eye between two screen points, degrees.
double angleBetween_deg(const Screen& screen, const glm::dvec2& a_px, const glm::dvec2& b_px);

/// Eccentricity along each axis, degrees, y up: atan(offset_m / distance_m).
glm::dvec2 eccentricity_deg(const Screen& screen, const glm::dvec2& point_px);

/// The inverse of `eccentricity_deg`, for eccentricities within +-90 degrees.
glm::dvec2 pointAtEccentricity_px(const Screen& screen, const glm::dvec2& eccentricity_deg);

}  // namespace foci
