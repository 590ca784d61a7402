// Saccades, their oscillations and blinks, by velocity thresholds that follow the noise; and two
// published detectors with their published constants, for comparison.
#pragma once

#include <span>
#include <vector>

#include "gaze/events/event_settings.h"
#include "gaze/events/gaze_speed.h"
#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// Labels each sample as one of
///   fixation     gaze is stable; smooth pursuit included
///   saccade
///   oscillation  post-saccadic
///   blink        data loss of any length, and the motion of the eyelid before and after it
///
/// A saccade is a peak of speed above `saccade_deg_s` and above a multiple of the noise. It lasts
/// as long as the speed along the peak's direction stays above a lower threshold. Motion within 20
/// ms after a saccade is its oscillation if it is smaller, or if gaze has not come to rest before.
///
/// If noise hides the peaks, or if the shortest window is longer than a saccade, wider windows
/// follow. They show where a saccade was but not how long it lasted. Such a saccade gets the
/// duration that is typical of its amplitude in healthy adults.
/// @param sights  without spikes
/// @param blinks  one for each sample: the tracker itself reports a blink
std::vector<GazeState> labelSaccades(std::span<const TimedSight> sights,
                                     const std::vector<bool>& blinks, double rate_Hz,
                                     const SightNoise& noise, const EventSettings& settings);

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
