// Lines of sight: from points on a flat screen and back, in the frames of the world and of a head
// that moves, and of one eye or both.
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

/// The mean of both eyes' points. While one eye is missing, the result is the other eye's point,
/// moved by half of the usual offset between the two. The offset is an exponentially weighted mean
/// of the last moments, because the two lines of sight need not cross on the screen.
class Cyclopean {
 public:
  /// @param time_s  never decreases
  /// @return nothing if both eyes are missing
  std::optional<glm::dvec2> combine(double time_s, const std::optional<glm::dvec2>& left_px,
                                    const std::optional<glm::dvec2>& right_px);

 private:
  std::optional<glm::dvec2> half_px_{};  // half of the usual offset, from left to right
  double time_s_ = 0.0;                  // when both eyes were last seen
};

/// The line of sight of a sample in the recording's world. Without a head pose: in the eye frame,
/// which does not move. Nothing if the sample has no gaze.
std::optional<glm::dvec3> sightInWorld(const GazeSample& sample, const Screen& screen);

/// The point where the head `now` sees what `sample` looked at, far away. Without head poses: the
/// sample's own point. Nothing if the sample has no gaze, or if it lies behind.
std::optional<glm::dvec2> pointSeenBy_px(const GazeSample& now, const GazeSample& sample,
                                         const Screen& screen);

/// Where an eye midway between both stands in the head's frame. The median over the samples that
/// have both origins, or 0.
glm::dvec3 middleOfEyes_m(const std::vector<GazeSample>& samples);

}  // namespace foci
