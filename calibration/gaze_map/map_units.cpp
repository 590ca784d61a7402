#include "calibration/gaze_map/map_units.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/input_error.h"
#include "gaze/sources/rows.h"

namespace foci {
namespace {

constexpr std::array<std::string_view, 3> kUnitNames{"deg", "norm", "direction"};
constexpr double kMaxAngle_deg = 89.0;  // the tangent of 90 is infinite

constexpr std::size_t kMaxRows = 2'000'000;
constexpr double kMaxGaze = 1e6;

/// Of a target's coordinates in each unit.
constexpr std::array<glm::dvec2, 3> kTargetRange{{{-80.0, 80.0}, {-1.0, 2.0}, {-6.0, 6.0}}};

}  // namespace

std::string_view nameOf(MapUnits units) { return kUnitNames[static_cast<std::size_t>(units)]; }

std::optional<MapUnits> mapUnitsNamed(std::string_view name) {
  const auto found = std::ranges::find(kUnitNames, name);
  if (found == kUnitNames.end()) return std::nullopt;
  return static_cast<MapUnits>(found - kUnitNames.begin());
}

glm::dvec2 onPlane(const GazeFrame& frame, const glm::dvec2& point) {
  switch (frame.units) {
    case MapUnits::deg:
      return glm::tan(glm::radians(glm::clamp(point, -kMaxAngle_deg, kMaxAngle_deg)));
    case MapUnits::norm:
      return (point - 0.5) * frame.screen.size_m * glm::dvec2(1.0, -1.0) / frame.screen.distance_m;
    case MapUnits::direction:
      return point;
  }
  return point;
}

glm::dvec2 fromPlane(const GazeFrame& frame, const glm::dvec2& point) {
  switch (frame.units) {
    case MapUnits::deg:
      return glm::degrees(glm::atan(point));
    case MapUnits::norm:
      return 0.5 + point * glm::dvec2(1.0, -1.0) * frame.screen.distance_m / frame.screen.size_m;
    case MapUnits::direction:
      return point;
  }
  return point;
}

double angle_deg(const glm::dvec2& a, const glm::dvec2& b) {
  const glm::dvec3 u(a, 1.0), v(b, 1.0);
  // atan2 keeps its digits at small angles, where acos loses half of them.
  return glm::degrees(std::atan2(glm::length(glm::cross(u, v)), glm::dot(u, v)));
}

glm::dvec2 degPerUnit(const GazeFrame& frame, const glm::dvec2& point) {
  constexpr double kStep =
      1e-5;  // of a unit; the error of a central difference is of the order of its square
  const auto along = [&](const glm::dvec2& step) {
    return angle_deg(onPlane(frame, point - step), onPlane(frame, point + step)) / (2.0 * kStep);
  };
  return {along({kStep, 0.0}), along({0.0, kStep})};
}

glm::dvec2 fromPixels(const GazeFrame& frame, const Screen& screen, const glm::dvec2& point_px) {
  const glm::dvec2 norm = point_px / glm::dvec2(screen.size_px);
  const GazeFrame of_screen{.units = MapUnits::norm, .screen = screen};
  return frame.units == MapUnits::norm ? norm : fromPlane(frame, onPlane(of_screen, norm));
}

glm::dvec2 toPixels(const GazeFrame& frame, const Screen& screen, const glm::dvec2& point) {
  const GazeFrame of_screen{.units = MapUnits::norm, .screen = screen};
  const glm::dvec2 norm =
      frame.units == MapUnits::norm ? point : fromPlane(of_screen, onPlane(frame, point));
  return norm * glm::dvec2(screen.size_px);
}

std::vector<GazePair> readGazePairs(const std::filesystem::path& file, MapUnits units) {
  NamedTable table(file, "a header row x y x_target y_target");
  const std::size_t x = table.column("x"), y = table.column("y");
  const std::size_t x_target = table.column("x_target"), y_target = table.column("y_target");
  const auto time = table.find("time_s"), weight = table.find("weight");
  const glm::dvec2& range = kTargetRange[static_cast<std::size_t>(units)];
  std::vector<GazePair> pairs;
  while (table.next()) {
    if (pairs.size() == kMaxRows) {
      throw table.error("more than 2 million rows: not a calibration");
    }
    const auto gaze_x = table.position(x, 0, -kMaxGaze, kMaxGaze);
    const auto gaze_y = table.position(y, 1, -kMaxGaze, kMaxGaze);
    const auto target_x = table.number(x_target, range.x, range.y);
    const auto target_y = table.number(y_target, range.x, range.y);
    if (!target_x || !target_y) throw table.error("a row without a target");
    GazePair pair{.target = {*target_x, *target_y}};
    if (gaze_x && gaze_y) pair.gaze = glm::dvec2(*gaze_x, *gaze_y);
    if (time) pair.time_s = table.number(*time, -1e12, 1e12);
    if (weight) pair.weight = table.number(*weight, 0.0, 1e9).value_or(1.0);
    pairs.push_back(pair);
  }
  if (pairs.empty()) throw InputError(table.fileName(), "no rows below the header");
  return pairs;
}

}  // namespace foci
