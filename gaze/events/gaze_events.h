// Labels and events of a complete recording.
#pragma once

#include <optional>
#include <vector>

#include "gaze/events/event_settings.h"
#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// The state of every sample by thresholds that follow the noise: `Detector::rules`.
/// @param trace   its rate must be known
/// @param screen  the screen of the samples, with known size and distance
std::vector<GazeState> labelByRules(const GazeTrace& trace, const Screen& screen,
                                    const EventSettings& settings);

/// An interval of one state. Positions are absent in blinks and data loss. Of an uncalibrated
/// signal (`GazeTrace::relative`), positions, amplitudes and speeds are absent.
struct GazeEvent {
  GazeState kind = GazeState::lost;
  double onset_s = 0.0;  ///< on the recording's clock
  double duration_s = 0.0;
  std::optional<glm::dvec2> position_px{};      ///< mean of a fixation, end of a saccade
  std::optional<glm::dvec2> start_px{};         ///< saccades only
  std::optional<double> amplitude_deg{};        ///< saccades only: angle from start to end
  std::optional<double> peak_velocity_deg_s{};  ///< saccades only
  std::optional<double> probability{};  ///< of its kind, mean over its samples; `trained` only
};

/// Events in order of time. They end where the rate changes. Neighbouring fixations are merged and
/// short ones left out, as `EventSettings` says.
/// @param states  one for each sample
std::vector<GazeEvent> eventsOf(const std::vector<GazeState>& states, const GazeTrace& trace,
                                const Screen& screen, const EventSettings& settings = {});

/// `eventsOf` with the labels of `labelEvents`, and their probabilities.
std::vector<GazeEvent> detectEvents(const GazeTrace& trace, const Screen& screen,
                                    const EventSettings& settings = {});

}  // namespace foci
