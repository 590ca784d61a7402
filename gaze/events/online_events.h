// Online detection: fixations, saccades and other states while the samples arrive.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "gaze/events/event_settings.h"
#include "gaze/events/gaze_speed.h"
#include "gaze/events/pursuit.h"
#include "gaze/events/trained_events.h"
#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// The detector's knowledge after a sample has arrived.
struct GazeNow {
  GazeState state = GazeState::lost;
  /// Time of the sample that `state` belongs to. This sample is older than the newest by the delay.
  double state_time_s = 0.0;
  /// The point of fixation. During saccades, blinks and data loss it is the last fixation. Absent
  /// before the first one.
  std::optional<glm::dvec2> fixation_px{};
  /// Time of the sample whose head sees the fixation at `fixation_px`.
  double fixation_time_s = 0.0;
  double fixation_error_deg = 0.0;  ///< standard error of `fixation_px`, from the sample noise
};

/// How far the online detector looks ahead, in samples.
struct Lookahead {
  Lookahead(double rate_Hz, const EventSettings& settings);

  std::size_t delay = 0;  ///< from a sample to the newest one, when it gets its label
  std::size_t hop = 1;    ///< so many samples are labelled in one step
};

/// A causal detector for rates from 25 to 2000 Hz, and the point of fixation. Each sample gets the
/// label that the samples up to `delay_s` after it tell. `rules` labels it as the offline detector
/// would if the recording began 0.4 s before. The time per sample and the memory do not grow.
class OnlineEvents {
 public:
  /// @param screen   the screen of the samples, with known size and distance
  /// @param rate_Hz  nominal, > 0
  OnlineEvents(const Screen& screen, double rate_Hz, const EventSettings& settings = {});

  /// @param sample  later than the previous one
  GazeNow push(const GazeSample& sample);

  /// Number of samples from the one that `GazeNow::state` belongs to, to the newest. It is 0 at low
  /// rates.
  std::size_t delaySamples() const { return ahead_.delay; }
  /// The same in seconds at the nominal rate. Never above `EventSettings::delay_s`.
  double delay_s() const { return static_cast<double>(ahead_.delay) / rate_Hz_; }

 private:
  void labelNext();
  void noteCalm(GazeState label);
  void forgetOld();
  GazeNow pushTrained(const GazeSample& sample);
  GazeNow waitFor(const GazeSample& sample, const TimedSight& sight);
  GazeState settle(const GazeSample& sample, const TimedSight& sight, GazeState label);
  bool follow(const GazeSample& sample, const TimedSight& sight, GazeState label);
  void fixate(const GazeSample& sample, const TimedSight& sight);

  Screen screen_;
  double rate_Hz_;
  EventSettings settings_;
  Lookahead ahead_;
  std::deque<GazeSample> samples_{};  // those that wait for their state
  std::vector<TimedSight> sights_{};  // the newest
  std::vector<bool> blinks_{};        // of `sights_`
  std::size_t settled_ = 0;           // sights_[0] to sights_[settled_ - 1] have their state
  std::deque<GazeState> labels_{};    // labels of the samples from `settled_` on
  std::size_t calm_from_ = 0;         // since this sample, gaze is stable and present
  std::size_t context_from_ = 0;      // what happened before does not change the next labels
  RecentNoise noise_;
  std::optional<TrainedEvents> trained_{};
  double noise_deg_ = 0.0;  // standard deviation of a sample's error along each axis
  std::optional<double> last_present_s_{};
  GazeNow now_{};
  StableGaze stable_{};
  /// Samples of the fixation, whose mean is `fixation_px`, and the sums of their points: of those
  /// before the last `position_s` or the last saccade, and of the others.
  struct Point {
    double time_s = 0.0;
    glm::dvec2 point_px{0.0};
    glm::dvec3 sight{0.0};
  };
  struct Sum {
    glm::dvec2 points_px{0.0};
    double count = 0.0;
    void add(const glm::dvec2& point_px, double sign = 1.0) {
      points_px += sign * point_px;
      count += sign;
    }
    glm::dvec2 mean_px() const { return points_px / count; }
  };
  std::deque<Point> fixation_{};
  Sum before_{}, recent_{};
  std::optional<double> landed_s_{};  // time of the first sample after the last saccade
};

/// True for fixation and pursuit, the states in which the retinal image is stable.
bool isStable(GazeState state);

/// A sample's point on the screen as a direction. In the world, if the recording has head poses: a
/// fixation is stable in the world, while the head turns.
TimedSight sightOf(const GazeSample& sample, const Screen& screen);

}  // namespace foci
