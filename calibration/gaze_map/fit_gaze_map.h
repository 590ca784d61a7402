// Fits a gaze map to calibration samples and decides how much model they bear.
#pragma once

#include "calibration/gaze_map/gaze_map.h"
#include "calibration/gaze_map/gaze_pairs.h"

namespace foci {

/// What a fit tells besides the map.
struct GazeFit {
  GazeMap map;
  /// Held-out error of each model tried, deg, from `offset` on; absent where the targets do not
  /// bear it.
  std::array<std::optional<double>, 4> cross_validated_deg;
  std::vector<glm::dvec2> refused;  ///< targets that the fit gave no weight: nobody looked at them
  double ms = 0.0;
};

/// Robust fit (Ceres, Tukey's loss on whole targets, whose samples were first reduced to a robust
/// location). The order is chosen by leave-one-target-out error; a higher one must lower it
/// noticeably. Terms above the affine are shrunk towards 0, and the map towards the affine fit, as
/// far as cross-validation asks for it.
/// @param model  forces an order
/// @throws InputError where gaze is missing at too many targets, targets are too few, collinear or
///   contradict each other
GazeFit fitGazeMap(std::span<const GazePair> pairs, const GazeFrame& frame,
                   std::optional<GazeModel> model = std::nullopt);

}  // namespace foci
