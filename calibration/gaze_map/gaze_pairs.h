// The samples of a gaze calibration: gaze, measured while the observer looks at a target.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "calibration/gaze_map/map_units.h"

namespace foci {

struct GazePair {
  std::optional<glm::dvec2> gaze{};  ///< as the tracker reports it; absent in a blink or data loss
  glm::dvec2 target{0.0};            ///< in the calibration's units
  std::optional<double> time_s{};
  double weight = 1.0;  ///< >= 0
};

/// Reads `x y x_target y_target [time_s] [weight]`. A header row names the columns, in any order;
/// tabs, commas or spaces separate them. `n/a`, `nan`, `.` or nothing in x or y is data loss.
/// Targets must lie within +-80 deg, -1 to 2 screens, or +-6 on the plane; gaze within +-1e6.
/// @throws InputError by file and line
std::vector<GazePair> readGazePairs(const std::filesystem::path& file, MapUnits units);

}  // namespace foci
