// An observer who looks from target to target, for demos and tests with known truth. Simulated, and
// labelled as such wherever it is shown.
#pragma once

#include <cstdint>
#include <vector>

#include "gaze/geometry/gaze_sample.h"

namespace foci {

/// A point that the observer wants to look at, for a while.
struct GazeTarget {
  glm::dvec2 point_px{0.0};
  double dwell_s = 0.0;  ///< until the next target appears; > 0
};

/// Each with its usual range in a healthy adult. Set an amplitude or a rate to 0 to do without.
struct OculomotorSettings {
  double latency_s = 0.2;      ///< from target to saccade, mean (0.15 to 0.25)
  double latency_sd_s = 0.03;  ///< never below 0.08 s in all: no express saccades
  double landing_error =
      0.05;  ///< SD, as part of the amplitude; corrected by a second saccade above 1 deg
  double drift_deg_s = 0.3;   ///< speed of the slow wander in a fixation (0.1 to 0.5)
  double tremor_deg = 0.005;  ///< SD of the 70 to 100 Hz oscillation (10 to 40 arcsec)
  double noise_deg = 0.03;    ///< SD of each sample's measurement error, each axis (video trackers)
  double blink_rate_Hz = 0.2;      ///< blinks a second (0.1 to 0.4)
  double blink_duration_s = 0.15;  ///< mean, eye not seen (0.1 to 0.3)
};

struct SimulatedGaze {
  GazeTrace trace;                ///< `simulated` is set; begins at 0 s; `screen` is the one given
  std::vector<GazeState> states;  ///< the truth, one a sample: fixation, saccade or blink
};

/// Follows the targets from the first, where gaze begins, to the end of the last one's dwell.
/// Deterministic: the same arguments give the same trace with every compiler and library, up to the
/// rounding of the mathematical functions.
/// @param screen   with all of its quantities known
/// @param rate_Hz  10 to 20,000
SimulatedGaze simulateGaze(const std::vector<GazeTarget>& targets, const Screen& screen,
                           double rate_Hz, std::uint64_t seed,
                           const OculomotorSettings& settings = {});

}  // namespace foci
