// Fits the display's pose and each eye's kappa to a table of samples of a binocular tracker.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "calibration/binocular/binocular_map.h"

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
  std::vector<std::string> warnings{};  ///< what is unusual about the eyes and the tracker's frame
};

/// Bundle adjustment: Ceres minimises the angles between lines of sight and targets under Cauchy's
/// loss, starting at `nominal`. From one head position, a rotation of the display cannot be told
/// from a kappa common to both eyes. So the head must have moved nearer and to the side.
/// @throws InputError with fewer than 20 samples or 3 targets, where the samples do not separate
///   pose from kappa (deviations above 20 mm or 1 deg), or where the eyes' distance, their order or
///   the axes of the targets are impossible
BinocularFit fitBinocular(std::span<const BinocularSample> samples, const BinocularMap& nominal);

/// Reads `left_origin_x_mm left_origin_y_mm left_origin_z_mm left_direction_x left_direction_y
/// left_direction_z`, the same with `right_`, and `x_target_mm y_target_mm`.
/// - Eye centres and directions (of any length) are in the tracker's frame.
/// - Targets are on the display, from its centre, x right, y up.
/// - A header row names the columns, in any order; other columns are ignored. Tabs, commas,
///   semicolons or blanks separate them.
/// - An eye with an absent field (`n/a`, `nan`, `.`, nothing) is data loss. The columns of one eye
///   may be missing altogether.
/// @throws InputError by file and line
std::vector<BinocularSample> readBinocularPairs(const std::filesystem::path& file);

}  // namespace foci
