// Fixations of an observer who moves. To keep a point of the scene in view, the eyes turn while the
// head moves past it. The direction of gaze then turns in the world as in smooth pursuit; the point
// that it meets rests.
#pragma once

#include <span>
#include <vector>

#include "app/replay/gaze_in_scene.h"
#include "gaze/events/event_settings.h"
#include "gaze/events/gaze_events.h"

namespace foci {

/// Makes a fixation of each pursuit that rests on a point of the scene. Let p be the median of the
/// points that its sights meet, and u the direction to p from where the eye is. Gaze less the turn
/// of u must be a fixation by the rule of `StableGaze`. An eye that does not move changes nothing.
/// @param samples  in order of time; their states follow
void fixateRestingPoints(std::vector<GazeEvent>& events, std::span<SightSample> samples,
                         const EventRules& rules);

}  // namespace foci
