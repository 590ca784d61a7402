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

/// A longer window is longer than most saccades.
inline constexpr double kWide_s = 0.022;
/// Minimum threshold of a peak in such a window.
inline constexpr double kWidePeak_deg_s = 20.0;
/// A peak threshold that misses most small saccades.
inline constexpr double kBlurredPeak_deg_s = 90.0;

/// How much the samples of a recording scatter. Standard deviations along each axis.
struct SightNoise {
  double sample_deg = 0.0;  ///< error of a sample
  /// Error of the velocity over `scaleWindow_s(0)`, `(1)`, ... Beyond the scales that the detector
  /// looks at (`mayHideSaccades`), the noise of the previous scale stands in for theirs.
  std::vector<double> velocity_deg_s{};
};

/// The longest time between two samples that belong together. Nobody knows what gaze did during a
/// longer one, so velocities and intervals of stable gaze end there.
double longestStep_s(double rate_Hz);

/// Length of the window of a scale. It doubles from one scale to the next. The first window holds
/// three samples or more.
double scaleWindow_s(std::size_t scale, double rate_Hz, const EventSettings& settings);

/// Whether velocity noise may hide saccades at a scale, so that the detector looks at wider
/// windows.
bool mayHideSaccades(double noise_deg_s, std::size_t scale, double rate_Hz,
                     const EventSettings& settings);

/// @param sights   a second or more, so that fixations prevail
/// @param rate_Hz  nominal sampling rate, > 0
SightNoise noiseOf(std::span<const TimedSight> sights, double rate_Hz,
                   const EventSettings& settings);

/// The noise while samples arrive: of the last `noise_span_s`, measured anew four times a second.
/// In the first second it is measured more often. Online and offline detector share it, so that
/// their labels differ only where the online detector has not yet seen the samples that decide.
class RecentNoise {
 public:
  RecentNoise(double rate_Hz, const EventSettings& settings)
      : rate_Hz_(rate_Hz), settings_(settings) {}

  /// Takes notice of new samples.
  /// @param sights  the samples until now, of which those before `noise_span_s` may be missing
  /// @return whether the noise was measured
  bool update(std::span<const TimedSight> sights);

  const SightNoise& value() const { return noise_; }

 private:
  double rate_Hz_;
  EventSettings settings_;
  SightNoise noise_{};
  double begin_s_ = 0.0, measured_s_ = 0.0;
};

/// Removes spikes: samples that leave for less than 25 ms and come back, as no eye can move. They
/// are replaced by the line between their neighbours.
std::vector<TimedSight> withoutSpikes(std::span<const TimedSight> sights, double rate_Hz,
                                      const SightNoise& noise);

}  // namespace foci
