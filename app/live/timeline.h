// The timeline of a recording that plays, at the lower edge of the window of `foci live`.
#pragma once

#include "app/live/sources.h"
#include "gaze/live/trace_player.h"

namespace foci {

/// Draws buttons, and a bar with fixations, data loss and event markers. A click on the bar seeks.
/// @return its height, px
float drawTimeline(TracePlayer& player, const Playback& playback);

}  // namespace foci
