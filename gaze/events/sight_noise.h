// The noise of a recording, measured as by Engbert and Kliegl (2003) but on changes of velocity;
// and the removal of spikes.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "gaze/events/event_settings.h"
#include "gaze/events/gaze_speed.h"

namespace foci {

/// Number of window lengths for which noise is measured. Each is twice as long as the one before.
inline constexpr std::size_t kNoiseScales = 5;
/// No noise is measured over longer windows. The noise of the previous scale stands in for theirs.
inline constexpr double kMaxNoiseWindow_s = 0.25;

/// How much the samples of a recording scatter. Standard deviations along each axis.
struct SightNoise {
  double sample_deg = 0.0;  ///< error of a sample
  std::vector<double>
      velocity_deg_s{};  ///< error of the velocity over `scaleWindow_s(0)`, `(1)`, ...
};

/// The longest time between two samples that belong together. Nobody knows what gaze did during a
/// longer one, so velocities and intervals of stable gaze end there.
double longestStep_s(double rate_Hz);

/// Length of the window of a scale. It doubles from one scale to the next. The first window holds
/// three samples or more.
double scaleWindow_s(std::size_t scale, double rate_Hz, const EventSettings& settings);

/// @param sights   a second or more, so that fixations prevail
/// @param rate_Hz  nominal sampling rate, > 0
SightNoise noiseOf(std::span<const TimedSight> sights, double rate_Hz,
                   const EventSettings& settings);

/// Removes spikes: samples that leave for less than 25 ms and come back, as no eye can move. They
/// are replaced by the line between their neighbours.
std::vector<TimedSight> withoutSpikes(std::span<const TimedSight> sights, double rate_Hz,
                                      const SightNoise& noise);

}  // namespace foci
