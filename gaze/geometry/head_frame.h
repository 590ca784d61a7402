// Directions and points between the frames of the world and of a head that moves.
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "gaze/geometry/gaze_sample.h"

namespace foci {

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
