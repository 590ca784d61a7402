#include "app/record/gaze_marker.h"

namespace foci {

bool isFixating(const FrameRecord& record) { return isStable(record.eye.state); }

void drawGazeMarkers(const Session& session, const FrameRecord& record, Image& image) {
  for (const glm::dvec2& point_px : session.gazePoints_px(record)) {
    drawMarker(image, point_px, !isFixating(record));
  }
}

}  // namespace foci
