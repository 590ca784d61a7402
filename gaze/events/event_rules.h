// The constants of event detection that labelled recordings choose.
#pragma once

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
  double wide_noise = 4.5;      ///< threshold of a peak in a wide window
  double noise_errors = 3.0;    ///< standard errors that are added to a measured velocity noise;
                                ///< not in the search (docs/results.md)
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

}  // namespace foci
