// Fixation or smooth pursuit: does gaze between two saccades stay in place or follow a target?
#pragma once

#include "gaze/events/drift_line.h"
#include "gaze/events/event_rules.h"

namespace foci {

/// Gaze between two saccades, gathered sample by sample.
class StableGaze : public DriftLine {
 public:
  void clear() { *this = {}; }

  /// Whether gaze moved too far for a fixation. With the default rules this is
  ///   0.37 - 0.39 ln T + 1.59 ln(D + 0.1) + 1.20 ln(S + 0.05) > 0.
  /// T is the duration in seconds. D is the distance from the first sample to the newest, and S the
  /// standard deviation of the samples, both in degrees. Within a second, a steady drift of about
  /// 0.9 degrees is pursuit.
  ///
  /// Pursuit continues after a catch-up saccade. So each neighbour of velocity u adds to the left
  /// side, for this interval's velocity v,
  ///   1.5 u.v / (|u| |v| + (3 deg/s)^2 + var(u) + var(v)).
  /// @param noise_deg  standard deviation of a sample's error along each axis, >= 0. The rule
  ///   subtracts from D and S the share that noise alone explains.
  /// @param before, after  null if there is no neighbour within 0.2 s, or if it is not known yet
  bool isPursuit(double noise_deg, const EventRules& rules, const StableGaze* before = nullptr,
                 const StableGaze* after = nullptr) const;

 private:
  double evidence(double noise_deg, const EventRules& rules) const;
};

}  // namespace foci
