// Gaze in space: the columns of a table that hold lines of sight and head poses, and the sample in
// one of its rows.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "gaze/geometry/gaze_sample.h"
#include "gaze/sources/trace_reader.h"

namespace foci {

class ColumnNames;
class Place;
class TableRow;

template <std::size_t N>
using ColumnsAt = std::optional<std::array<std::size_t, N>>;

/// Columns of one line of sight, counted from 0. See `SightColumns`.
struct SightAt {
  ColumnsAt<3> direction{}, point{}, origin{};
  ColumnsAt<2> angles{};
  ColumnsAt<4> quaternion{};
  std::optional<std::size_t> validity{};

  bool hasSight() const { return direction || point || angles || quaternion; }
};

struct SpaceLayout {
  SightAt both{};
  std::array<SightAt, 2> eyes{};  ///< left, right
  ColumnsAt<3> head_position{};
  ColumnsAt<4> head_quaternion{};
  ColumnsAt<3> head_angles{}, head_euler{};
  std::array<std::size_t, 3> euler_order{1, 0, 2};  ///< axes in the order of their turns
  bool from_head = false;                           ///< the head's direction replaces gaze
  AxisConvention axes{}, head_axes{};  ///< of gaze, of the head; a study states one for both
  bool in_world = false;               ///< the frame of the gaze columns; else the head's
  double origin_scale_m = 1.0, head_scale_m = 1.0;
  double angle_scale_rad = 1.0, head_angle_scale_rad = 1.0;
  /// The tangents of `angles` are the first and second part of the direction, in `axes`, over its
  /// third one (Project Aria).
  bool tangents = false;
  std::optional<std::size_t> depth_m{};  ///< of the point that both eyes look at along `both`
  glm::dvec2 scale{1.0}, offset{0.0};    ///< of angles, in their unit

  bool hasSight() const { return both.hasSight() || eyes[0].hasSight() || eyes[1].hasSight(); }
  bool hasHead() const { return head_quaternion || head_angles || head_euler; }
};

/// Finds the columns that a study names.
/// @throws InputError if one is missing, or if the study leaves open a frame or axes that the
///   result depends on
SpaceLayout spaceLayoutOf(const Place& place, const ColumnNames& names,
                          const SpaceColumns& columns);

/// Finds the head's columns that a study names, beside gaze in the head's frame.
/// @throws InputError as `spaceLayoutOf`
void takeHead(const Place& place, const ColumnNames& names, const SpaceColumns& columns,
              SpaceLayout& layout);

/// @throws InputError if the study states none
AxisConvention axesOf(const Place& place, const SpaceColumns& columns);

/// Reads head pose, origins and directions into a sample, in the head's frame. A vector or
/// quaternion of zeros, or with an absent field, is absent. The sample's own direction is that of
/// both eyes' column, else the mean of the eyes'. With a depth, both eyes look at that point.
/// @throws InputError for text, a quaternion or direction whose length is not 1, or an angle that
///   no eye has
void readSpace(const TableRow& row, const SpaceLayout& layout, GazeSample& sample);

/// The head stays where it is.
void loseGaze(GazeSample& sample);

/// The mean of the eyes' directions, or the one that there is.
std::optional<glm::dvec3> meanDirection(const std::array<EyeSample, 2>& eyes);

}  // namespace foci
