// The coordinates in which gaze and targets come, and angles between them.
#pragma once

#include <optional>
#include <string_view>

#include "gaze/geometry/default_screen.h"
#include "gaze/geometry/gaze_sample.h"

namespace foci {

enum class MapUnits {
  deg,        ///< eccentricity from the screen's centre, atan(offset / distance) along each axis
  norm,       ///< 0 to 1 over the screen, origin top-left, y down
  direction,  ///< where the line of sight cuts the plane z = 1
};

/// "deg", "norm", "direction".
std::string_view nameOf(MapUnits units);
std::optional<MapUnits> mapUnitsNamed(std::string_view name);

/// Units, and the screen without which normalised coordinates have no angle.
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

/// Degrees that a small step along each axis takes at `point`.
glm::dvec2 degPerUnit(const GazeFrame& frame, const glm::dvec2& point);

/// A point of the screen in the frame's units: x to the right, and y up except for `norm`.
glm::dvec2 fromPixels(const GazeFrame& frame, const Screen& screen, const glm::dvec2& point_px);
glm::dvec2 toPixels(const GazeFrame& frame, const Screen& screen, const glm::dvec2& point);

}  // namespace foci
