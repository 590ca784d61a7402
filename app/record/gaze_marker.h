// The ring that shows in an image where the observer looks.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "app/graphics/image.h"
#include "app/session/frame_record.h"

namespace foci {

/// Whether the observer fixates now. Otherwise (saccade, blink, data loss) the ring is broken.
inline bool isFixating(const FrameRecord& record) { return isStable(record.eye.state); }

/// Draws a ring for each view of the image.
/// @param points_px  `Session::gazePoints_px`
inline void drawGazeMarkers(const std::vector<glm::dvec2>& points_px, const FrameRecord& record,
                            Image& image) {
  for (const glm::dvec2& point_px : points_px) {
    drawMarker(image, point_px, !isFixating(record));
  }
}

}  // namespace foci
