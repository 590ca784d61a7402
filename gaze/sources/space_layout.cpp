#include <algorithm>
#include <cmath>
#include <string>

#include "base/text.h"
#include "gaze/sources/column_names.h"
#include "gaze/sources/recording_formats.h"
#include "gaze/sources/table_layout.h"
#include "gaze/sources/table_row.h"

namespace foci {
namespace {

constexpr double kUnitLength = 0.05;  // a unit vector with two decimals is within this of length 1
constexpr double kMaxPlaceInSpace_m = 1e6;  // a float there has steps of 6 cm
constexpr double kMaxAngle_rad = 7.0;       // more than a whole turn
constexpr double kMaxVertical_rad = glm::half_pi<double>() + 1e-4;  // 90 degrees, rounded

template <std::size_t N>
ColumnsAt<N> placesOf(const Place& place, const ColumnNames& names, const ColumnList<N>& list) {
  if (list[0].empty()) return std::nullopt;
  std::array<std::size_t, N> places{};
  for (std::size_t i = 0; i < N; ++i) {
    places[i] = names.named(list[i]);
    if (std::find(places.begin(), places.begin() + static_cast<std::ptrdiff_t>(i), places[i]) !=
        places.begin() + static_cast<std::ptrdiff_t>(i)) {
      throw place.error("column " + shown(list[i]) + " is named twice in one list");
    }
  }
  return places;
}

SightAt sightAt(const Place& place, const ColumnNames& names, const SightColumns& columns) {
  SightAt at{.direction = placesOf(place, names, columns.direction),
             .point = placesOf(place, names, columns.point),
             .origin = placesOf(place, names, columns.origin),
             .angles = placesOf(place, names, columns.angles),
             .quaternion = placesOf(place, names, columns.quaternion)};
  if (at.direction.has_value() + at.point.has_value() + at.angles.has_value() +
          at.quaternion.has_value() >
      1) {
    throw place.error(
        "direction, angles, quaternion and point of one line of sight: expected only one of them");
  }
  return at;
}

/// Numbers of a row; nothing if one is absent.
template <std::size_t N>
std::optional<std::array<double, N>> numbersIn(const TableRow& row,
                                               const std::array<std::size_t, N>& at) {
  std::array<double, N> values{};
  for (std::size_t i = 0; i < N; ++i) {
    const auto value = row.number(at[i]);
    if (!value && row.isAbsent(at[i])) return std::nullopt;
    if (!value) row.fail(at[i], "expected a number");
    if (row.isMissing(*value)) return std::nullopt;
    values[i] = *value;
  }
  return values;
}

std::optional<glm::dvec3> vectorIn(const TableRow& row, const ColumnsAt<3>& at) {
  const auto values = at ? numbersIn(row, *at) : std::nullopt;
  if (!values) return std::nullopt;
  return glm::dvec3((*values)[0], (*values)[1], (*values)[2]);
}

std::optional<glm::dvec3> placeIn(const TableRow& row, const ColumnsAt<3>& at,
                                  const AxisConvention& axes, double scale_m) {
  const auto place = vectorIn(row, at);
  if (!place) return std::nullopt;
  const glm::dvec3 place_m = scale_m * axes.vector(*place);
  if (!(glm::length(place_m) <= kMaxPlaceInSpace_m)) {
    row.fail((*at)[0],
             "farther away than 1000 km: is its unit right (gaze.head_scale_m, "
             "gaze.origin_scale_m)?");
  }
  return place_m;
}

std::optional<glm::dquat> rotationIn(const TableRow& row, const ColumnsAt<4>& at,
                                     const AxisConvention& axes) {
  const auto values = at ? numbersIn(row, *at) : std::nullopt;
  if (!values) return std::nullopt;
  const auto& [x, y, z, w] = *values;
  const glm::dquat q(w, x, y, z);
  const double length = glm::length(q);
  if (length == 0.0) return std::nullopt;
  if (std::abs(length - 1.0) > kUnitLength) {
    row.fail((*at)[0], "with the next three columns expected a quaternion x, y, z, w of length 1");
  }
  return axes.rotation(q / length);
}

std::optional<glm::dvec3> directionIn(const TableRow& row, const SightAt& at,
                                      const SpaceLayout& layout,
                                      const std::optional<glm::dvec3>& from_m) {
  if (at.direction) {
    const auto d = vectorIn(row, at.direction);
    const double length = d ? glm::length(*d) : 0.0;
    if (length == 0.0) return std::nullopt;
    if (std::abs(length - 1.0) > kUnitLength) {
      row.fail(
          (*at.direction)[0],
          "with the next two columns expected a direction of length 1; gaze.point names a point "
          "in space, and gaze.missing a code for data loss");
    }
    return layout.axes.vector(*d / length);
  }
  if (at.angles) {
    const auto angles = numbersIn(row, *at.angles);
    if (!angles) return std::nullopt;
    glm::dvec2 turn{(*angles)[0], (*angles)[1]};
    turn = layout.angle_scale_rad * (layout.scale * turn + layout.offset);
    for (int axis : {0, 1}) {
      if (std::abs(turn[axis]) <= kMaxAngle_rad) continue;
      row.fail((*at.angles)[static_cast<std::size_t>(axis)],
               "more than a turn: is gaze.angle_units right?");
    }
    if (layout.tangents) {
      for (int axis : {0, 1}) {
        if (std::abs(turn[axis]) < glm::half_pi<double>()) continue;
        row.fail((*at.angles)[static_cast<std::size_t>(axis)], "expected less than a quarter turn");
      }
      return glm::normalize(layout.axes.vector({std::tan(turn.x), std::tan(turn.y), 1.0}));
    }
    // Some programs count from 0 to 360 degrees.
    if (std::abs(std::remainder(turn.y, glm::two_pi<double>())) > kMaxVertical_rad) {
      row.fail((*at.angles)[1],
               "a vertical angle of more than a quarter turn: is the order of gaze.angles to the "
               "right, upwards, and gaze.angle_units right?");
    }
    return glm::dvec3(std::sin(turn.x) * std::cos(turn.y), std::sin(turn.y),
                      -std::cos(turn.x) * std::cos(turn.y));
  }
  if (at.quaternion) {
    const auto rotation = rotationIn(row, at.quaternion, layout.axes);
    if (!rotation) return std::nullopt;
    return *rotation * glm::dvec3(0.0, 0.0, -1.0);
  }
  const auto point_m = placeIn(row, at.point, layout.axes, layout.origin_scale_m);
  if (!point_m || !from_m || !(glm::distance(*point_m, *from_m) > 1e-6)) return std::nullopt;
  return glm::normalize(*point_m - *from_m);
}

/// By the angles in three columns, about `axes` of the head, one after another.
std::optional<glm::dquat> turnIn(const TableRow& row, const SpaceLayout& layout,
                                 const std::array<std::size_t, 3>& columns,
                                 const std::array<std::size_t, 3>& order,
                                 const std::array<glm::dvec3, 3>& axes) {
  const auto angles = numbersIn(row, columns);
  if (!angles) return std::nullopt;
  glm::dquat turned(1.0, 0.0, 0.0, 0.0);
  for (const std::size_t i : order) {
    const double turn_rad = layout.head_angle_scale_rad * (*angles)[i];
    if (std::abs(turn_rad) > kMaxAngle_rad) {
      row.fail(columns[i], "more than a turn: is gaze.angle_units right?");
    }
    turned = turned * glm::angleAxis(turn_rad, axes[i]);
  }
  return turned;
}

std::optional<HeadInWorld> headIn(const TableRow& row, const SpaceLayout& layout) {
  constexpr glm::dvec3 kX(1.0, 0.0, 0.0), kY(0.0, 1.0, 0.0), kZ(0.0, 0.0, 1.0);
  std::optional<glm::dquat> world_from_head;
  if (layout.head_angles) {  // to the right, upwards, and roll to the right
    world_from_head = turnIn(row, layout, *layout.head_angles, {0, 1, 2},
                             {glm::dvec3(0.0, -1.0, 0.0), kX, glm::dvec3(0.0, 0.0, -1.0)});
  } else if (layout.head_euler) {
    // About the recording's own axes. The product has the same form in a left-handed frame.
    world_from_head = turnIn(row, layout, *layout.head_euler, layout.euler_order, {kX, kY, kZ});
    if (world_from_head) world_from_head = layout.head_axes.rotation(*world_from_head);
  } else {
    world_from_head = rotationIn(row, layout.head_quaternion, layout.head_axes);
  }
  if (!world_from_head) return std::nullopt;
  HeadInWorld head{.world_from_head = *world_from_head};
  if (layout.head_position) {
    const auto position_m =
        placeIn(row, layout.head_position, layout.head_axes, layout.head_scale_m);
    if (!position_m) return std::nullopt;
    head.position_m = *position_m;
  }
  return head;
}

/// Where an eye stands beside the middle between both, as Aria's files have it.
constexpr double kHalfIpd_m = 0.0315;

/// Turns both eyes to the point at a depth along the direction of both.
void turnToDepth(const TableRow& row, std::size_t column, GazeSample& sample) {
  const auto depth_m = row.number(column);
  if (!depth_m && !row.isAbsent(column)) row.fail(column, "expected a number");
  if (!depth_m || !(*depth_m > kHalfIpd_m) || !sample.direction) return;
  for (const std::size_t side : {0, 1}) {
    EyeSample& eye = sample.eyes[side];
    eye.origin_m = glm::dvec3(side == 0 ? -kHalfIpd_m : kHalfIpd_m, 0.0, 0.0);
    eye.direction = glm::normalize(*depth_m * *sample.direction - *eye.origin_m);
  }
}

void refuseWrongSight(const Place& place, const SpaceLayout& layout) {
  if (!layout.from_head && !layout.hasSight()) {
    throw place.error(
        "a head without gaze: expected gaze.direction, angles, quaternion or point; with "
        "gaze.from_head = true the head's direction stands for gaze");
  }
  if (layout.from_head && layout.hasSight()) {
    throw place.error("gaze.from_head = true: expected no columns of gaze");
  }
  if (layout.from_head && !layout.hasHead()) {
    throw place.error(
        "gaze.from_head = true: expected gaze.head_quaternion, gaze.head_angles or "
        "gaze.head_euler");
  }
}

double radiansPer(AngleUnit unit) { return unit == AngleUnit::rad ? 1.0 : glm::radians(1.0); }

}  // namespace

bool isEulerOrder(std::string_view order) {
  std::string letters(order);
  std::ranges::sort(letters);
  return letters == "xyz";
}

std::vector<std::string> worldColumnNames() {
  return {"time", "head x", "head y", "head z", "head qx", "head qy", "head qz", "head qw"};
}

TraceColumns worldColumns(TraceColumns columns, double time_scale_s) {
  columns.time = "time";
  columns.time_scale_s = time_scale_s;
  columns.missing.reset();
  columns.space.head_position = {"head x", "head y", "head z"};
  columns.space.head_quaternion = {"head qx", "head qy", "head qz", "head qw"};
  columns.space.frame = SightFrame::world;
  columns.space.axes = "right-up-back";
  return columns;
}

AxisConvention axesOf(const Place& place, const SpaceColumns& columns) {
  const auto axes = AxisConvention::named(columns.axes.value_or(""));
  if (!axes) throw place.error("gaze.axes: expected " + std::string(kAxesExpected));
  return *axes;
}

void takeHead(const Place& place, const ColumnNames& names, const SpaceColumns& columns,
              SpaceLayout& layout) {
  layout.head_position = placesOf(place, names, columns.head_position);
  layout.head_quaternion = placesOf(place, names, columns.head_quaternion);
  layout.head_angles = placesOf(place, names, columns.head_angles);
  layout.head_euler = placesOf(place, names, columns.head_euler);
  layout.head_scale_m = columns.head_scale_m;
  layout.head_angle_scale_rad = radiansPer(columns.angle_units);
  if (layout.head_quaternion.has_value() + layout.head_angles.has_value() +
          layout.head_euler.has_value() >
      1) {
    throw place.error(
        "gaze.head_quaternion, gaze.head_angles and gaze.head_euler: expected only one of them");
  }
  if (layout.head_position && !layout.hasHead()) {
    throw place.error(
        "gaze.head_position: expected the head's orientation, too (gaze.head_quaternion, "
        "gaze.head_angles or gaze.head_euler); foci turns the display with the head");
  }
  for (std::size_t i : {0, 1, 2}) {
    layout.euler_order[i] = static_cast<std::size_t>(columns.head_euler_order[i] - 'x');
  }
}

SpaceLayout spaceLayoutOf(const Place& place, const ColumnNames& names,
                          const SpaceColumns& columns) {
  SpaceLayout layout{.both = sightAt(place, names, columns.both),
                     .from_head = columns.from_head,
                     .in_world = columns.frame == SightFrame::world,
                     .origin_scale_m = columns.origin_scale_m,
                     .angle_scale_rad = radiansPer(columns.angle_units)};
  for (std::size_t side : {0, 1}) layout.eyes[side] = sightAt(place, names, columns.eyes[side]);
  takeHead(place, names, columns, layout);
  refuseWrongSight(place, layout);
  if (layout.hasHead() && !layout.from_head && !columns.frame) {
    throw place.error("gaze.frame: expected \"head\" or \"world\", the frame of the gaze columns");
  }
  if (layout.in_world && !layout.hasHead()) {
    throw place.error(
        "gaze.frame = \"world\": expected gaze.head_quaternion, gaze.head_angles or "
        "gaze.head_euler; without the head's orientation, gaze.frame = \"head\" shows the lines of "
        "sight before a head that does not move, where [eye] places it");
  }
  layout.axes = layout.head_axes = axesOf(place, columns);
  return layout;
}

void loseGaze(GazeSample& sample) {
  sample.direction.reset();
  for (EyeSample& eye : sample.eyes) eye.direction.reset();
}

std::optional<glm::dvec3> meanDirection(const std::array<EyeSample, 2>& eyes) {
  glm::dvec3 sum(0.0);
  for (const EyeSample& eye : eyes) sum += eye.direction.value_or(glm::dvec3(0.0));
  if (!(glm::length(sum) > 0.5)) return std::nullopt;
  return glm::normalize(sum);
}

void readSpace(const TableRow& row, const SpaceLayout& layout, GazeSample& sample) {
  sample.head = layout.hasHead() ? headIn(row, layout) : std::nullopt;
  sample.direction.reset();
  // Gaze in the world has no place in the head while the head is lost.
  if (layout.in_world && !sample.head) return;
  const auto in_head = [&](const glm::dvec3& v) {
    return layout.in_world ? glm::conjugate(sample.head->world_from_head) * v : v;
  };
  const glm::dvec3 rest_m = layout.in_world ? sample.head->position_m : glm::dvec3(0.0);
  for (std::size_t side : {0, 1}) {
    const SightAt& at = layout.eyes[side];
    const auto origin_m = placeIn(row, at.origin, layout.axes, layout.origin_scale_m);
    const auto direction = directionIn(row, at, layout, origin_m ? origin_m : rest_m);
    EyeSample& eye = sample.eyes[side];
    if (at.validity && !row.isValid(*at.validity)) continue;
    if (direction) eye.direction = in_head(*direction);
    if (origin_m) eye.origin_m = in_head(*origin_m - rest_m);
  }
  if (layout.from_head) {
    if (sample.head) sample.direction = kStraightAhead;
  } else if (layout.both.hasSight()) {
    const auto origin_m = placeIn(row, layout.both.origin, layout.axes, layout.origin_scale_m);
    const auto direction = directionIn(row, layout.both, layout, origin_m ? origin_m : rest_m);
    if (direction) sample.direction = in_head(*direction);
    if (layout.depth_m) turnToDepth(row, *layout.depth_m, sample);
  } else {
    sample.direction = meanDirection(sample.eyes);
  }
}

}  // namespace foci
