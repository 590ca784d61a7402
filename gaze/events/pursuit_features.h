// What tells pursuit from fixation: the motion of gaze between two saccades.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "gaze/events/drift_line.h"
#include "gaze/events/gaze_speed.h"

namespace foci {

/// docs/events.md lists them with unit and formula.
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
