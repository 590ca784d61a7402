// Two published detectors with their published constants, for comparison.
#pragma once

#include <span>
#include <vector>

#include "gaze/events/gaze_speed.h"
#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// How far each detector looks to both sides of a sample.
inline constexpr double kVelocityWindow_s = 0.02, kDispersionWindow_s = 0.1;

/// I-VT (Salvucci and Goldberg 2000): a sample whose velocity is at least the threshold belongs to
/// a saccade. The velocity is that over a window of 20 ms (Olsen 2012). Missing samples are blinks.
std::vector<GazeState> labelByVelocity(std::span<const TimedSight> sights, double rate_Hz,
                                       double saccade_deg_s);

/// I-DT (Salvucci and Goldberg 2000): a sample belongs to a fixation if some window of 100 ms holds
/// it and has a dispersion, max(x) - min(x) + max(y) - min(y), of 1 degree at most.
std::vector<GazeState> labelByDispersion(std::span<const TimedSight> sights);

}  // namespace foci
