// Settings of the event detection.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "gaze/events/event_rules.h"

namespace foci {

/// What labels the samples.
enum class Detector {
  trained,  ///< trees trained on labelled recordings (trained_events.h)
  rules,    ///< velocity thresholds that follow the noise (saccades.h)
  ivt,      ///< a velocity threshold (Salvucci and Goldberg 2000, Olsen 2012)
  idt       ///< a dispersion threshold (Salvucci and Goldberg 2000)
};

inline constexpr std::array<Detector, 4> kDetectors = {Detector::trained, Detector::rules,
                                                       Detector::ivt, Detector::idt};

/// "trained", "rules", "ivt", "idt".
constexpr std::string_view nameOf(Detector detector) {
  constexpr std::array<std::string_view, kDetectors.size()> kNames = {"trained", "rules", "ivt",
                                                                      "idt"};
  return kNames[static_cast<std::size_t>(detector)];
}

/// Nothing for another name.
constexpr std::optional<Detector> detectorNamed(std::string_view name) {
  for (const Detector detector : kDetectors) {
    if (nameOf(detector) == name) return detector;
  }
  return std::nullopt;
}

/// The velocity threshold is a minimum: in a noisy recording the detectors raise it with the noise.
///
/// 30 deg/s, 75 ms, 0.5 deg and 60 ms are the values of Tobii's I-VT filter (Olsen 2012). The
/// others were chosen by hand. The agreement with human coders bounds them, see `foci events
/// --score` and the test LabelSamples.AgreesWithHumanCodersAsTheyDoAmongThemselves.
struct EventSettings {
  Detector detector = Detector::trained;
  /// False: pursuit counts as fixation. Absent: true, but false for a headset without head poses,
  /// because turns of the head then look like pursuit.
  std::optional<bool> pursuit{};
  double saccade_deg_s = 30.0;  ///< minimum peak velocity of a saccade; `rules` and `ivt` only
  /// Minimum length of the window whose slope is the velocity; `rules` only.
  double window_s = 0.011;
  double delay_s = 0.020;      ///< how far the online detector may look ahead
  double max_gap_s = 0.02;     ///< shorter data loss is bridged, unless the eyelid moves beside it
  double max_blink_s = 0.5;    ///< longer data loss is `lost`, shorter data loss is a blink
  double position_s = 0.1;     ///< a fixation's position is the mean over its last 0.1 s
  double merge_gap_s = 0.075;  ///< two fixations become one if the time between them is shorter
  double merge_deg = 0.5;      ///< and the angle between them smaller
  double min_fixation_s = 0.06;  ///< shorter fixations are not reported as events
  EventRules rules{};
};

}  // namespace foci
