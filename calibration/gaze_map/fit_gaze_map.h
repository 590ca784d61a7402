// Fits a gaze map to calibration samples and chooses the order of its polynomial.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "calibration/gaze_map/gaze_map.h"
#include "calibration/gaze_map/map_units.h"

namespace foci {

struct GazeFit {
  GazeMap map;
  /// Held-out error of each model tried, deg, from `offset` on; absent where targets are too few.
  std::array<std::optional<double>, 4> cross_validated_deg;
  std::vector<glm::dvec2> refused;  ///< targets left out: the observer looked elsewhere, or
                                    ///< the samples lie as far apart as the targets
  double ms = 0.0;                  ///< time that the fit took
};

/// Robust fit: each target's samples are reduced to a robust location, then Ceres minimises Tukey's
/// loss over the targets. The order is chosen by leave-one-target-out error: a higher order must
/// lower its variance by 5 % (affine) or 20 % (second, third). Cross-validation also chooses how
/// far the terms above the affine shrink towards 0, and the map towards the affine fit.
/// @param forced  fits this model only
/// @throws InputError where no sample has gaze, or targets are too few, collinear or contradict
///   each other
GazeFit fitGazeMap(std::span<const GazePair> pairs, const GazeFrame& frame,
                   std::optional<GazeModel> forced = std::nullopt);

/// The samples of the targets that the fit did not leave out.
std::vector<GazePair> keptPairs(std::span<const GazePair> pairs, const GazeFit& fit);

}  // namespace foci
