// Fixation or smooth pursuit: does gaze between two saccades stay in place or follow a target?
#pragma once

#include <glm/glm.hpp>

#include "gaze/events/event_rules.h"

namespace foci {

/// Statistics of gaze between two saccades, gathered sample by sample.
class StableGaze {
 public:
  void add(double time_s, const glm::dvec3& direction);
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

  double newest_s() const { return newest_s_; }
  double first_s() const { return first_s_; }
  double count() const { return count_; }

 private:
  double evidence(double noise_deg, const EventRules& rules) const;
  /// Least-squares slope of the directions over time, and its variance along each axis.
  glm::dvec3 velocity_deg_s() const;
  double variance_deg2_s2(double noise_deg) const;
  double agreement(const StableGaze& other, double noise_deg, double still_deg_s) const;

  double count_ = 0.0;
  double first_s_ = 0.0, newest_s_ = 0.0;
  glm::dvec3 first_{0.0}, newest_{0.0}, mean_{0.0};
  double squares_ = 0.0;                    // sum of squared distances from the mean, rad^2
  double mean_s_ = 0.0, squares_s2_ = 0.0;  // mean of the times, and their squares around it
  glm::dvec3 products_{0.0};                // sum of the products of time and direction around it
};

}  // namespace foci
