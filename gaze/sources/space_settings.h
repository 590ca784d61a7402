// How a table describes gaze in space: the names of its columns, their frame, axes and units.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "gaze/geometry/axis_convention.h"

namespace foci {

/// Columns' names, all or none of them empty.
template <std::size_t N>
using ColumnList = std::array<std::string, N>;

/// The frame of the gaze columns.
enum class SightFrame { head, world };

enum class AngleUnit { deg, rad };

/// Columns of one line of sight. Name at most one of direction, angles, quaternion and point.
struct SightColumns {
  ColumnList<3> direction{};  ///< x, y, z
  /// Horizontal, to the right; vertical, upwards. The vertical angle is measured from the
  /// horizontal plane (Fick): d = (sin h cos v, sin v, -cos h cos v).
  ColumnList<2> angles{};
  ColumnList<4> quaternion{};  ///< x, y, z, w; turns the forward axis to the line of sight
  ColumnList<3> point{};       ///< a point in space that the eye looks at
  ColumnList<3> origin{};      ///< of the line of sight

  bool hasSight() const {
    return !direction[0].empty() || !angles[0].empty() || !quaternion[0].empty() ||
           !point[0].empty();
  }
};

/// Gaze in space, as a study describes the columns of a table. See `TraceColumns`.
struct SpaceColumns {
  SightColumns both{};                 ///< of both eyes together
  std::array<SightColumns, 2> eyes{};  ///< left, right
  ColumnList<3> head_position{};
  ColumnList<4> head_quaternion{};  ///< x, y, z, w; turns the head's axes to the world's
  /// To the right, upwards, and clockwise for the observer, turned in this order: about the
  /// upward axis of the world, then about the head's own axes.
  ColumnList<3> head_angles{};
  /// About the recording's own x, y and z, in the sense of its axes, as Unity's `eulerAngles`.
  ColumnList<3> head_euler{};
  std::string head_euler_order = "yxz";  ///< of the turns about the head's own axes
  bool from_head = false;                ///< the head's forward direction replaces gaze
  std::optional<SightFrame> frame{};     ///< needed with a head pose
  std::optional<std::string> axes{};     ///< as `AxisConvention::named` takes it; needed
  double origin_scale_m = 1.0;           ///< metres per unit of origins and points
  double head_scale_m = 1.0;             ///< metres per unit of the head's position
  AngleUnit angle_units = AngleUnit::deg;
  /// The tangents of `angles` are the first and second part of the direction, in `axes`, over its
  /// third one (Project Aria).
  bool angles_are_tangents = false;
  std::string depth{};  ///< of the point that both eyes look at along `both`, metres

  bool hasHead() const {
    return !head_quaternion[0].empty() || !head_angles[0].empty() || !head_euler[0].empty();
  }
  bool hasSight() const { return both.hasSight() || eyes[0].hasSight() || eyes[1].hasSight(); }
};

/// Straight ahead of a head.
inline constexpr glm::dvec3 kStraightAhead{0.0, 0.0, -1.0};

/// Whether each of x, y and z is named once.
bool isEulerOrder(std::string_view order);

/// Turns the recording's world into the scene's: p_scene = offset + scale R p.
struct SceneAlignment {
  glm::dvec4 rotation{0.0, 0.0, 0.0, 1.0};  ///< R as a quaternion x, y, z, w; any length but 0
  double scale = 1.0;
  glm::dvec3 offset_m{0.0};
};

}  // namespace foci
