// Fixation or pursuit: whether gaze that is in no saccade stays in place or follows something.
#pragma once

#include <glm/glm.hpp>

namespace foci {

/// What gaze did between two saccades, gathered sample by sample.
class StableGaze {
 public:
  void add(double time_s, const glm::dvec3& direction);
  void clear() { *this = {}; }

  /// Whether it went too far for a fixation. With the time T in seconds, the way D from the first
  /// sample to the newest and the samples' standard deviation S, both in degrees,
  ///   0.37 - 0.39 ln T + 1.59 ln(D + 0.1) + 1.20 ln(S + 0.05) > 0,
  /// fitted to two coders of 18 recordings (gaze.md); left out one observer at a time the
  /// coefficients hardly change. After a second that is about 0.9 degrees of steady drift.
  /// @param noise_deg  standard deviation along each axis of a sample's error, >= 0: taken off D
  ///   and S
  bool isPursuit(double noise_deg) const;

 private:
  double count_ = 0.0;
  double first_s_ = 0.0, newest_s_ = 0.0;
  glm::dvec3 first_{0.0}, newest_{0.0}, mean_{0.0};
  double squares_ = 0.0;  // of the distances from the mean, rad^2
};

}  // namespace foci
