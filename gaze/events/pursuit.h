// Fixation or smooth pursuit: does gaze between two saccades stay in place or follow a target?
// The line through its directions, a rule on it, and features of it for the trained detector.
#pragma once

#include <array>
#include <cstddef>
#include <glm/glm.hpp>
#include <span>

#include "gaze/events/event_settings.h"
#include "gaze/events/gaze_speed.h"

namespace foci {

/// The least-squares line through directions, and what it leaves unexplained. The memory does not
/// grow with the samples.
class DriftLine {
 public:
  void add(double time_s, const glm::dvec3& direction);

  double count() const { return count_; }
  double first_s() const { return first_s_; }
  double newest_s() const { return newest_s_; }
  double duration_s() const { return newest_s_ - first_s_; }
  const glm::dvec3& first() const { return first_; }
  const glm::dvec3& newest() const { return newest_; }

  glm::dvec3 velocity_deg_s() const;
  /// Standard error of the velocity along each axis.
  /// @param noise_deg  standard deviation of a sample's error along each axis
  double velocityError_deg_s(double noise_deg) const;
  /// Distance from the first to the newest sample, without what noise explains.
  double distance_deg(double noise_deg) const;
  /// Mean squared distance from the mean direction.
  double variance_deg2() const;
  /// Share of the samples' variance that the line explains, 0 to 1.
  double straightness() const;

  /// The cosine between two velocities u and v, less if noise or stillness leaves their directions
  /// open: u.v / (|u| |v| + still^2 + var(u) + var(v)).
  /// @param still_deg_s  slower motion has hardly a direction
  double agreement(const DriftLine& other, double noise_deg, double still_deg_s) const;

 private:
  double velocityVariance_deg2_s2(double noise_deg) const;

  double count_ = 0.0;
  double first_s_ = 0.0, newest_s_ = 0.0;
  glm::dvec3 first_{0.0}, newest_{0.0}, mean_{0.0};
  double squares_ = 0.0;                    // sum of squared distances from the mean, rad^2
  double mean_s_ = 0.0, squares_s2_ = 0.0;  // mean of the times, and their squares around it
  glm::dvec3 products_{0.0};                // sum of the products of time and direction around it
};

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

/// models/README.md lists them with unit and formula.
inline constexpr std::size_t kPursuitFeatures = 33;
using PursuitFeatureVector = std::array<float, kPursuitFeatures>;

/// The longest window that the features look at, around the sample or before it.
inline constexpr double kPursuitWindow_s = 0.4;

/// Stable gaze around a sample.
struct StableContext {
  const DriftLine* whole = nullptr;    ///< since the last saccade; offline until the next one
  std::span<const TimedSight> near{};  ///< the samples of `whole` that the windows may hold
  double time_s = 0.0;                 ///< of the sample
  bool centred = false;                ///< windows lie around the sample, else before it
  const DriftLine *before = nullptr, *before_that = nullptr;  ///< previous stable gaze, if near
  const DriftLine* after = nullptr;                           ///< the next, if known and near
  double noise_deg = 0.0;                                     ///< error of a sample along each axis
};

/// Stable gaze that is farther away in time is no neighbour.
inline constexpr double kNeighbour_s = 0.3;

PursuitFeatureVector pursuitFeatures(const StableContext& context);

}  // namespace foci
