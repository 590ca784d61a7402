// Labels and events of a whole recording.
#pragma once

#include <optional>
#include <vector>

#include "gaze/events/event_settings.h"
#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// The state of every sample, decided with the whole recording in view.
/// @param trace   with a rate, > 0
/// @param screen  that the samples are on, with all of its quantities known
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

/// Events in order of time: runs of labels, one a sample, with fixations merged and short ones
/// dropped.
std::vector<GazeEvent> eventsOf(const std::vector<GazeState>& states, const GazeTrace& trace,
                                const Screen& screen, const EventSettings& settings = {});

/// `eventsOf` the labels of `labelSamples`.
std::vector<GazeEvent> detectEvents(const GazeTrace& trace, const Screen& screen,
                                    const EventSettings& settings = {});

}  // namespace foci
