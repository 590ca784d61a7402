// The axes of other programs: which way x, y and z point, and what follows for directions, points
// and rotations.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <string_view>

namespace foci {

/// Turns vectors of another program's frame into foci's: x right, y up, looking along -z.
///   p = M p',  R = M R' M^T
/// The columns of M are where x', y' and z' point. M of a left-handed frame has determinant -1.
class AxisConvention {
 public:
  /// foci's own axes: "right-up-back", as in OpenXR, OpenGL and Tobii's user coordinates.
  AxisConvention() = default;

  /// @param text  where x, y and z point, e.g. "right-up-forward" (Unity, left-handed)
  /// @return nothing unless the three are of right/left, up/down and forward/back, one each
  static std::optional<AxisConvention> named(std::string_view text);

  glm::dvec3 vector(const glm::dvec3& p) const { return from_other_ * p; }
  /// @param q  unit
  glm::dquat rotation(const glm::dquat& q) const;

 private:
  glm::dmat3 from_other_{1.0};
};

/// What `AxisConvention::named` takes, for messages.
inline constexpr std::string_view kAxesExpected =
    "where x, y and z point: \"right-up-back\" (OpenXR, OpenGL), \"right-up-forward\" (Unity), "
    "\"right-down-forward\" (OpenCV), \"forward-left-up\" (ROS), or other such words";

}  // namespace foci
