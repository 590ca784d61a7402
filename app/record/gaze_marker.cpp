#include "app/record/gaze_marker.h"

namespace foci {

bool isFixating(const FrameRecord& record) { return isStable(record.eye.state); }

void drawGazeMarkers(const std::vector<glm::dvec2>& points_px, const FrameRecord& record,
                     Image& image) {
  for (const glm::dvec2& point_px : points_px) {
    drawMarker(image, point_px, !isFixating(record));
  }
}

}  // namespace foci
