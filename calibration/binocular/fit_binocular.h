// Fits the display's pose and each eye's kappa to samples of a binocular tracker.
#pragma once

#include <span>

#include "calibration/binocular/binocular.h"

namespace foci {

/// A first guess from the samples alone: the display whose targets lie nearest to the lines of
/// sight. Linear least squares of the distances across the lines, without kappa.
/// @throws InputError where the samples do not determine the display's pose
BinocularMap roughBinocularMap(std::span<const BinocularSample> samples);

struct BinocularFit {
  BinocularMap map;
  double accuracy_deg = 0.0;            ///< mean angle between line of sight and target
  double translation_sd_m = 0.0;        ///< largest of the axes, from the covariance
  double kappa_sd_deg = 0.0;            ///< largest of both eyes and axes
  double vergence_bias_before_D = 0.0;  ///< median of measured minus true vergence, without kappa
  double vergence_bias_after_D = 0.0;   ///< with kappa
};

/// Bundle adjustment: Ceres minimises the angles between lines of sight and targets under Cauchy's
/// loss, starting at `nominal`. From one head position, a rotation of the display cannot be told
/// from a kappa common to both eyes. So the head must have moved nearer and to the side.
/// @throws InputError with fewer than 20 samples or 3 targets, or where the samples do not separate
///   pose from kappa (deviations above 20 mm or 1 deg)
BinocularFit fitBinocular(std::span<const BinocularSample> samples, const BinocularMap& nominal);

}  // namespace foci
