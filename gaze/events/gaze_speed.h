// The velocity of the line of sight. Its noise, measured as by Engbert and Kliegl (2003) but on
// changes of velocity; and the removal of spikes.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include "gaze/events/event_settings.h"

namespace foci {

/// A sample as a direction. The direction is absent where the sample has no gaze.
struct TimedSight {
  double time_s = 0.0;
  std::optional<glm::dvec3> direction{};  ///< unit
};

/// Least-squares slope of the directions over time. It is exact for a steady turn much smaller than
/// a radian, and it does not depend on the place on the screen.
/// @return degrees of visual angle per second; nothing with fewer than two directions
std::optional<glm::dvec3> velocityOfSight_deg_s(std::span<const TimedSight> samples);

/// The velocity at a sample.
struct SightVelocity {
  glm::dvec3 deg_s{0.0};
  double speed_deg_s = 0.0;  ///< length of `deg_s`
  /// Noise relative to the noise of a complete window. It is above 1 beside data loss, where the
  /// window holds fewer samples.
  double noise_gain = 1.0;
};

/// The velocity at every sample that has a direction. Each window reaches half of `window_s` to
/// both sides, and at least to both neighbours. A window ends at a sample without a direction, and
/// at a step in time of more than `longest_step_s`.
std::vector<std::optional<SightVelocity>> velocitiesOfSight(std::span<const TimedSight> samples,
                                                            double window_s, double longest_step_s);

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

/// The noise while samples arrive: of the last `noise_span_s`, measured again four times a second.
/// In the first second it is measured more often. Online and offline detector share it, so that
/// their labels differ only where the online detector has not yet seen the samples that decide.
///
/// The standard deviation of a velocity is that of the median change between neighbouring windows.
/// Steady pursuit does not raise it, and saccades hardly do. `noise_errors` standard errors of this
/// estimate are added: early estimates are less precise, and a threshold must not lie too low by
/// chance. The noise is 0 before eight changes.
class RecentNoise {
 public:
  /// @param rate_Hz  nominal sampling rate, > 0
  RecentNoise(double rate_Hz, const EventSettings& settings);

  void push(const TimedSight& sight);
  /// Measures the noise if it is time.
  /// @return whether it was
  bool update();
  const SightNoise& value() const { return noise_; }

 private:
  /// Changes of velocity over windows of one length.
  struct Changes {
    double window_s = 0.0;
    std::size_t step = 1;        ///< samples from a window to the next that does not overlap it
    std::size_t end = 0;         ///< number of the first sample that is not yet in `deg_s`
    std::vector<float> deg_s{};  ///< one for each sample before `end`; below 0 if unknown
  };

  void extend(Changes& changes);
  double measured_deg_s(Changes& changes, double errors);

  double rate_Hz_;
  EventSettings settings_;
  std::size_t span_;                  // samples
  std::vector<TimedSight> sights_{};  // the newest, at least `span_`
  std::size_t dropped_ = 0;           // number of the first of them
  Changes of_samples_{};
  std::vector<Changes> of_scales_{};
  std::vector<float> sorted_{};
  SightNoise noise_{};
  double begin_s_ = 0.0, measured_s_ = 0.0;
};

/// Removes spikes: samples that leave for less than 25 ms and come back, as no eye can move. They
/// are replaced by the line between their neighbours.
std::vector<TimedSight> withoutSpikes(std::span<const TimedSight> sights, double rate_Hz,
                                      const SightNoise& noise);

}  // namespace foci
