// What a calibration is made from: where gaze was measured while a target was looked at.
#pragma once

#include <filesystem>
#include <vector>

#include "calibration/gaze_map/map_units.h"

namespace foci {

struct GazePair {
  std::optional<glm::dvec2> gaze{};  ///< as the tracker gives it; absent in a blink or a loss
  glm::dvec2 target{0.0};            ///< in the calibration's units
  std::optional<double> time_s{};
  double weight = 1.0;  ///< >= 0
};

/// Reads `x y x_target y_target [time_s] [weight]`: columns in any order, named by a header row,
/// separated by tabs, commas or spaces. `n/a`, `nan`, `.` or nothing in x or y is a loss. Targets
/// must lie within +-80 deg, -1 to 2 screens, or +-6 on the plane; gaze may have any finite numbers
/// up to 1e6.
/// @throws InputError by file and line
std::vector<GazePair> readGazePairs(const std::filesystem::path& file, MapUnits units);

}  // namespace foci
