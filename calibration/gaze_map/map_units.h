// The samples of a gaze calibration: their units, the angles between them, and their table.
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "gaze/geometry/gaze_sample.h"

namespace foci {

enum class MapUnits {
  deg,        ///< eccentricity from the screen's centre, atan(offset / distance) along each axis
  norm,       ///< 0 to 1 over the screen, origin top-left, y down
  direction,  ///< the point at which the line of sight cuts the plane z = 1
};

/// "deg", "norm", "direction".
std::string_view nameOf(MapUnits units);
std::optional<MapUnits> mapUnitsNamed(std::string_view name);

/// Units, and the screen that gives normalised coordinates an angle.
struct GazeFrame {
  MapUnits units = MapUnits::deg;
  Screen screen;
};

/// Point of the plane z = 1 that the line of sight cuts. Degrees beyond +-89 are taken as +-89.
glm::dvec2 onPlane(const GazeFrame& frame, const glm::dvec2& point);

/// The inverse of `onPlane`.
glm::dvec2 fromPlane(const GazeFrame& frame, const glm::dvec2& point);

/// Angle between two lines of sight given on the plane z = 1. Degrees, 0 to 180.
double angle_deg(const glm::dvec2& a, const glm::dvec2& b);

/// Angle of a small step along each axis at `point`, degrees per unit.
glm::dvec2 degPerUnit(const GazeFrame& frame, const glm::dvec2& point);

/// Converts a point of the screen, in pixels, to the frame's units (x right; y up, in `norm` down),
/// and back.
glm::dvec2 fromPixels(const GazeFrame& frame, const Screen& screen, const glm::dvec2& point_px);
glm::dvec2 toPixels(const GazeFrame& frame, const Screen& screen, const glm::dvec2& point);

struct GazePair {
  std::optional<glm::dvec2> gaze{};  ///< as the tracker reports it; absent in a blink or data loss
  glm::dvec2 target{0.0};            ///< in the calibration's units
  std::optional<double> time_s{};
  double weight = 1.0;  ///< >= 0
  bool operator==(const GazePair&) const = default;
};

/// Reads `x y x_target y_target [time_s] [weight]`. A header row names the columns, in any order;
/// tabs, commas or spaces separate them. `n/a`, `nan`, `.` or nothing in x or y is data loss.
/// Targets must lie within +-80 deg, -1 to 2 screens, or +-6 on the plane; gaze within +-1e6.
/// @throws InputError by file and line
std::vector<GazePair> readGazePairs(const std::filesystem::path& file, MapUnits units);

}  // namespace foci
