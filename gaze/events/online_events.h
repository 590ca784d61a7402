// Fixations, saccades and the rest as they happen.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "gaze/events/event_settings.h"
#include "gaze/events/pursuit.h"
#include "gaze/events/saccades.h"
#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// What is known when a sample has arrived.
struct GazeNow {
  GazeState state = GazeState::lost;
  double state_time_s =
      0.0;  ///< the sample that `state` is of: earlier than the newest by the delay
  /// Where the observer fixates; in saccades, blinks and losses where he last did. Absent until the
  /// first fixation.
  std::optional<glm::dvec2> fixation_px{};
  double fixation_error_deg = 0.0;  ///< standard deviation of that, by the noise of the samples
};

/// A causal detector, fed sample by sample. Rates from 25 to 2000 Hz. It labels each sample as the
/// offline detector would if the recording began 0.4 s before and ended `delay_s` after
/// it, with the noise of the last seconds. Time a sample and memory do not grow.
class OnlineEvents {
 public:
  /// @param screen   that the samples are on, with all of its quantities known
  /// @param rate_Hz  nominal, > 0
  OnlineEvents(const Screen& screen, double rate_Hz, const EventSettings& settings = {});

  /// @param sample  later than the one before
  GazeNow push(const GazeSample& sample);

  /// How many samples `GazeNow::state` lies behind the newest: 0 where the rate is low.
  std::size_t delaySamples() const { return delay_; }
  /// The same in seconds at the nominal rate; never above `EventSettings::delay_s`.
  double delay_s() const { return static_cast<double>(delay_) / rate_Hz_; }

 private:
  void measure();
  void labelNext();
  GazeState settle(const GazeSample& sample, const TimedSight& sight, GazeState label);
  void fixate(const GazeSample& sample);

  Screen screen_;
  double rate_Hz_;
  EventSettings settings_;
  std::size_t delay_ = 0;
  std::size_t hop_ = 1;  // samples that are labelled at once
  std::vector<GazeSample> samples_{};
  std::vector<TimedSight> sights_{};
  std::vector<bool> blinks_{};
  std::size_t settled_ = 0;         // of the samples, from the front
  std::deque<GazeState> labels_{};  // of those that come next
  SightNoise noise_{};
  double measured_s_ = 0.0, begin_s_ = 0.0;
  std::optional<double> last_present_s_{};
  GazeNow now_{};
  StableGaze stable_{};
  std::deque<GazeSample> fixation_{};  // of which `fixation_px` is the mean
  std::optional<double> landed_s_{};   // its first sample since the last saccade
};

/// Whether gaze stays in place or follows something: the states in which the eye sees sharply.
bool isStable(GazeState state);

/// A sample as a direction on a screen.
TimedSight sightOf(const GazeSample& sample, const Screen& screen);

/// The online detector's state of every sample of a trace, its delay taken out.
std::vector<GazeState> labelSamplesOnline(const GazeTrace& trace, const Screen& screen,
                                          const EventSettings& settings = {});

}  // namespace foci
