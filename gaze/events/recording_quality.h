// How good a recording is, and whether the trained detector knows such recordings.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "gaze/events/event_labels.h"
#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// The peak speed of saccades as a power of their amplitude (Bahill, Clark and Stark 1975):
/// peak = at_1_deg * amplitude^exponent. Fitted to the logarithms.
struct MainSequence {
  int saccades = 0;
  double at_1_deg_deg_s = 0.0, exponent = 0.0;
};

struct RecordingQuality {
  double rate_Hz = 0.0;
  double jitter_s = 0.0;       ///< standard deviation of the intervals without gaps
  double lost = 0.0;           ///< share of the samples without gaze
  double longest_gap_s = 0.0;  ///< without gaze
  /// Root mean square of the angle from sample to sample within fixations. Absent without any.
  std::optional<double> rms_s2s_deg{};
  /// Standard deviation of the samples within fixations, both axes; the median fixation.
  std::optional<double> sd_deg{};
  double unjudged = 0.0;                        ///< share of the samples
  std::optional<MainSequence> main_sequence{};  ///< of five saccades or more
};

/// @param states, events  of the recording
RecordingQuality qualityOf(const GazeTrace& trace, const Screen& screen,
                           const std::vector<GazeState>& states,
                           const std::vector<GazeEvent>& events);

/// What lies outside of the range of the training data; nothing for detectors without training.
std::vector<std::string> rangeWarnings(const RecordingQuality& quality,
                                       const EventSettings& settings);

/// Why stretches are `unjudged`, what lies outside of the training's range, and that turns of the
/// head look like pursuit. A sentence each.
std::vector<std::string> eventWarnings(const GazeTrace& trace, const EventLabels& labels,
                                       const RecordingQuality& quality,
                                       const EventSettings& settings);

}  // namespace foci
