// A simulated observer who looks from target to target, for demos and for tests with known truth.
#pragma once

#include <cstdint>
#include <vector>

#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// A point that the observer tries to fixate for some time.
struct GazeTarget {
  glm::dvec2 point_px{0.0};
  double dwell_s = 0.0;  ///< until the next target appears; > 0
};

/// Ranges in brackets are usual in healthy adults. An amplitude or a rate of 0 switches an effect
/// off.
struct OculomotorSettings {
  double latency_s = 0.2;          ///< mean, from target to saccade (0.15 to 0.25)
  double latency_sd_s = 0.03;      ///< no latency is below 0.08 s: there are no express saccades
  double landing_error = 0.05;     ///< SD, as a share of the amplitude; above 1 deg it is corrected
  double drift_deg_s = 0.3;        ///< mean speed of drift in a fixation (0.1 to 0.5)
  double tremor_deg = 0.005;       ///< SD of the 70 to 100 Hz oscillation (10 to 40 arcsec)
  double noise_deg = 0.03;         ///< SD of a sample's measurement error along each axis
  double blink_rate_Hz = 0.2;      ///< blinks a second (0.1 to 0.4)
  double blink_duration_s = 0.15;  ///< mean time without gaze (0.1 to 0.3)
};

struct SimulatedGaze {
  GazeTrace trace;                ///< begins at 0 s; `simulated` is true
  std::vector<GazeState> states;  ///< the truth for each sample: fixation, saccade or blink
};

/// Gaze begins on the first target and ends with the dwell time of the last one. The same arguments
/// give the same trace with every compiler and library, up to the rounding of the mathematical
/// functions.
/// @param screen   with known size and distance
/// @param rate_Hz  10 to 20,000
SimulatedGaze simulateGaze(const std::vector<GazeTarget>& targets, const Screen& screen,
                           double rate_Hz, std::uint64_t seed,
                           const OculomotorSettings& settings = {});

}  // namespace foci
