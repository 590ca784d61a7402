// What tells pursuit from fixation: the motion of gaze between two saccades.
#pragma once

#include <array>
#include <cstddef>
#include <glm/glm.hpp>
#include <optional>
#include <span>

#include "gaze/events/gaze_speed.h"

namespace foci {

/// docs/events.md lists them with unit and formula.
inline constexpr std::size_t kPursuitFeatures = 33;
using PursuitFeatureVector = std::array<float, kPursuitFeatures>;

/// The longest window that the features look at, around the sample or before it.
inline constexpr double kPursuitWindow_s = 0.4;

/// A straight line through directions over time, and what it leaves unexplained. Sums are relative
/// to the first direction, so the memory does not grow.
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
  /// @param noise_deg  error of a sample along each axis
  double velocityError_deg_s(double noise_deg) const;
  /// Distance from the first to the newest sample, without what noise explains.
  double distance_deg(double noise_deg) const;
  /// Standard deviation of the samples, both axes, without what noise explains.
  double spread_deg(double noise_deg) const;
  /// Share of the samples' variance that the line explains, 0 to 1.
  double straightness() const;

 private:
  double variance_deg2() const;

  double count_ = 0.0, first_s_ = 0.0, newest_s_ = 0.0;
  glm::dvec3 first_{0.0}, newest_{0.0};
  double time_ = 0.0, times_ = 0.0, squares_ = 0.0;  // sums of t, t^2 and x.x
  glm::dvec3 sum_{0.0}, product_{0.0};               // sums of x and t x
};

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
