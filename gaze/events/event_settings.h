// Settings of the event detection, and its constants that labelled recordings choose.
#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace foci {

/// `foci_event_rules` (tests/bench/event_rules.cpp) measures them by leave-one-recording-out on the
/// labelled recordings of Andersson et al. (2017) and irf. Factors named ..._noise are standard
/// deviations of the velocity noise, so noise and sampling rate set the threshold.
struct EventRules {
  double peak_noise = 9.0;      ///< threshold of a saccade's peak
  double edge_deg_s = 22.0;     ///< minimum threshold of a saccade's edges
  double edge_noise = 4.0;      ///< threshold of a saccade's edges
  double rest_deg_s = 6.0;      ///< minimum of the next threshold
  double rest_noise = 3.0;      ///< faster motion after a saccade is oscillation
  double rest_s = 0.008;        ///< the oscillation ends after so much rest
  double oscillation_s = 0.02;  ///< and at most after so long
  double echo_ratio = 0.6;      ///< a smaller motion so soon after a saccade is its oscillation
  double hidden_noise = 5.0;    ///< noise may hide saccades: a wider window follows
  double wide_noise = 4.5;      ///< threshold of a peak in a wide window; the search's 3.5 finds
                                ///< too many saccades in simulated noise of 1 degree
  double noise_errors = 3.0;    ///< standard errors that are added to a measured velocity noise;
                                ///< not in the search
  double lid_rest_s = 0.03;     ///< an eyelid that rests for so long is open or closed
  double noise_span_s = 3.0;    ///< the noise at a sample is that of so long a time before it

  // Pursuit (`StableGaze`): the terms of its evidence.
  double pursuit_bias = 0.37;
  double pursuit_duration = -0.39;   ///< per unit of ln(duration)
  double pursuit_distance = 1.59;    ///< per unit of ln(distance)
  double pursuit_spread = 1.20;      ///< per unit of ln(standard deviation)
  double pursuit_neighbour = 1.5;    ///< a neighbour that moves in the same direction
  double pursuit_still_deg_s = 3.0;  ///< below it, the direction of motion is unreliable
};

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
