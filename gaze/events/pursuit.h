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
  /// @param noise_deg  standard deviation along each axis of a sample's error, >= 0: as much of D
  ///   and S as noise alone may make is taken off
  bool isPursuit(double noise_deg) const { return evidence(noise_deg) > 0.0; }

  /// The same where what gaze did before and after is known: who follows something goes on across a
  /// catch-up saccade. To the left side comes, for each neighbour with the velocity u against v,
  ///   1.5 u.v / (|u| |v| + (3 deg/s)^2 + the variances of both).
  /// The two constants were fitted as above, with the others held.
  /// @param before, after  null where there is none within 0.2 s
  bool isPursuit(double noise_deg, const StableGaze* before, const StableGaze* after) const;

  double newest_s() const { return newest_s_; }
  double first_s() const { return first_s_; }
  double count() const { return count_; }

 private:
  double evidence(double noise_deg) const;
  /// Least-squares slope of the directions, and its variance along each axis.
  glm::dvec3 velocity_deg_s() const;
  double variance_deg2_s2(double noise_deg) const;
  double agreement(const StableGaze& other, double noise_deg) const;

  double count_ = 0.0;
  double first_s_ = 0.0, newest_s_ = 0.0;
  glm::dvec3 first_{0.0}, newest_{0.0}, mean_{0.0};
  double squares_ = 0.0;  // of the distances from the mean, rad^2
  // Of times from their mean: squares, and products with the directions.
  double mean_s_ = 0.0, squares_s2_ = 0.0;
  glm::dvec3 products_{0.0};
};

}  // namespace foci
