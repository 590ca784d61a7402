// Stretches of a recording that tell nothing about eye movements.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "gaze/events/event_settings.h"
#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// Why a sample cannot be judged.
enum class SignalDoubt {
  none,
  slow,   ///< the rate is below 25 Hz: a fixation may hold a saccade
  lost,   ///< more than half of the second around it is lost
  white,  ///< white noise that is wider than saccades: it explains the changes of position
  frozen  ///< the position does not change in any digit for a second
};

/// Time with each doubt; `none` stays 0.
using DoubtTimes = std::array<double, 5>;

/// The doubt about each sample. Data loss for longer than `max_blink_s` is no doubt, because it is
/// labelled `lost`.
/// @param ahead_s  how far a later sample may be that is used: `kWholeRecording` for all
std::vector<SignalDoubt> signalDoubts(const GazeTrace& trace, const Screen& screen,
                                      const EventSettings& settings, double ahead_s);
inline constexpr double kWholeRecording = 1e9;

/// A sentence for each reason, with the time that it concerns. `rules` labels such stretches all
/// the same.
std::vector<std::string> doubtWarnings(const DoubtTimes& unjudged_s, Detector detector);

}  // namespace foci
