// Saccades, their oscillations, spikes and blinks in a stretch of samples, by thresholds that
// follow the noise.
#pragma once

#include <span>
#include <vector>

#include "gaze/events/event_settings.h"
#include "gaze/events/gaze_speed.h"
#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// How much the samples of a recording scatter.
struct SightNoise {
  double sample_deg = 0.0;  ///< standard deviation along each axis of a sample's error
  /// The same of the velocity over windows of `scaleWindow_s(0)`, `(1)`, ...
  std::vector<double> velocity_deg_s{};
};

/// Over a longer step in time nobody knows what gaze did: no velocity, and what is stable before it
/// and after it is told apart.
double longestStep_s(double rate_Hz);

/// Windows double from one scale to the next; the first holds three samples at least.
double scaleWindow_s(std::size_t scale, double rate_Hz, const EventSettings& settings);

/// @param sights   a second or more, so that fixations prevail
/// @param rate_Hz  nominal, > 0
SightNoise noiseOf(std::span<const TimedSight> sights, double rate_Hz,
                   const EventSettings& settings);

/// Samples that leave for less than 25 ms and come back, which no eye does, moved onto the line
/// between their neighbours.
std::vector<TimedSight> withoutSpikes(std::span<const TimedSight> sights, double rate_Hz,
                                      const SightNoise& noise);

/// fixation (gaze is stable, maybe in pursuit), saccade, oscillation, or blink (no gaze, however
/// long, and the motion of the lid before and after).
///
/// A saccade is a peak of speed above both `saccade_deg_s` and a multiple of the noise; it lasts
/// while the speed along the peak's direction stays above a lower threshold. What follows it within
/// 20 ms and is smaller, or still moves, is its oscillation. Where the noise hides peaks, or the
/// window is longer than a saccade, wider windows are tried: they show that and where there was a
/// saccade but not how long, so that it gets the duration that its amplitude has in healthy adults.
/// @param blinks  one a sight: what the tracker says itself
std::vector<GazeState> labelSaccades(std::span<const TimedSight> sights,
                                     const std::vector<bool>& blinks, double rate_Hz,
                                     const SightNoise& noise, const EventSettings& settings);

}  // namespace foci
