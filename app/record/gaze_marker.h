// The ring that shows in an image where the observer looks.
#pragma once

#include "app/graphics/image.h"
#include "app/session/session.h"

namespace foci {

/// Whether the observer fixates now. Otherwise (saccade, blink, data loss) the ring is broken.
bool isFixating(const FrameRecord& record);

/// Draws a ring for each view of the image.
void drawGazeMarkers(const Session& session, const FrameRecord& record, Image& image);

}  // namespace foci
