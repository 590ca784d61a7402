// Fixations and saccades as they happen, by a velocity threshold.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "gaze/events/gaze_speed.h"
#include "gaze/gaze.h"

namespace foci {

struct EventSettings {
  /// Gaze that turns faster is in a saccade: Tobii's I-VT. Slower thresholds cut up pursuit.
  double saccade_deg_s = 30.0;
  /// Span of the samples whose slope is the speed; half of it is the delay. Of 4 to 30 ms, 12
  /// agreed best with the human coders of 18 recordings at 500 Hz.
  double window_s = 0.012;
  double max_gap_s = 0.075;  ///< a loss up to this is filled with what was before it (Tobii)
  double max_blink_s = 0.5;  ///< a longer loss is lost gaze, a shorter one a blink
  double position_s =
      0.1;  ///< a fixation lies at the mean of this last part of it: follows pursuit
  double merge_gap_s = 0.075;  ///< fixations are one if less than this and (Tobii)
  double merge_deg = 0.5;      ///< less than this lies between them (Tobii)
  double oscillation_s =
      0.02;  ///< saccades with less rest between them are one: the eye still rings
  double min_fixation_s = 0.06;  ///< a shorter fixation is no event of its own (Tobii)
};

/// What is known when a sample has arrived.
struct GazeNow {
  GazeState state = GazeState::lost;
  double state_time_s =
      0.0;  ///< the sample that `state` is of: earlier than the newest by the delay
  /// Where the observer fixates; in saccades, blinks and losses where he last did. Absent until the
  /// first fixation.
  std::optional<glm::dvec2> fixation_px{};
};

/// A causal detector, fed sample by sample. Rates from 25 to 2000 Hz.
class OnlineEvents {
 public:
  /// @param screen   that the samples are on, with all of its quantities known
  /// @param rate_Hz  nominal, > 0: sets how many samples the window holds, at least two
  OnlineEvents(const Screen& screen, double rate_Hz, const EventSettings& settings = {});

  /// @param sample  later than the one before
  GazeNow push(const GazeSample& sample);

  /// How many samples `GazeNow::state` lies behind the newest: 0 where the rate is low.
  std::size_t delaySamples() const { return delay_; }
  /// The same in seconds at the nominal rate; never above half the window.
  double delay_s() const { return static_cast<double>(delay_) / rate_Hz_; }

 private:
  GazeState stateIn(std::size_t labelled) const;
  void fixate(const GazeSample& sample);

  Screen screen_;
  double rate_Hz_;
  EventSettings settings_;
  std::size_t delay_ = 0;
  double reach_s_ = 0.0;               // samples this far from the labelled one are in its window
  std::vector<GazeSample> samples_{};  // the newest, as many as the window holds
  std::vector<TimedSight> sights_{};   // of the same
  std::optional<double> last_present_s_{};
  GazeNow now_{};
  std::deque<GazeSample>
      fixation_{};  // labelled samples of the current fixation, `position_s` back
};

/// The online detector's state of every sample of a trace, its delay taken out.
std::vector<GazeState> labelSamples(const GazeTrace& trace, const Screen& screen,
                                    const EventSettings& settings = {});

/// A stretch of one state. Positions are absent in blinks and losses.
struct GazeEvent {
  GazeState kind = GazeState::lost;
  double onset_s = 0.0;  ///< on the recording's clock
  double duration_s = 0.0;
  std::optional<glm::dvec2> position_px{};  ///< of a fixation its mean, of a saccade its end
  std::optional<glm::dvec2> start_px{};     ///< of a saccade
  double amplitude_deg = 0.0;               ///< of a saccade, start to end; else 0
  double peak_velocity_deg_s = 0.0;         ///< of a saccade; else 0
};

/// Events in order of time: the labels of `labelSamples`, saccades joined with their oscillations,
/// fixations merged and short ones dropped.
std::vector<GazeEvent> detectEvents(const GazeTrace& trace, const Screen& screen,
                                    const EventSettings& settings = {});

}  // namespace foci
