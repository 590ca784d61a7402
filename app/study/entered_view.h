// A place to stand in a scan of a room, a street or a landscape.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <span>

#include "app/study/framing.h"

namespace foci {

/// How high the eye of a person who stands is above the ground.
inline constexpr double kStandingEye_m = 1.6;

struct StandingEye {
  glm::dvec3 position{0.0}, look_at{0.0};  ///< units of the file
  double free_m = 0.0;                     ///< up to what the eye looks at, or the border
  double nearest_m = 0.0;                  ///< of what is in view
};

/// Finds a place with ground below, free sight, and surfaces around. Of all such places the eye
/// takes the one with the longest free line, along which it looks; places with something near in
/// view come first. Works on a grid: a line is free if the cells along it hold no points.
/// @param share  of the scene's points that these are, up to 1
/// @return absent for an object, which has no such place: too small, or nothing around the eye; and
///         where the points lie too far apart to show what is near, as in a survey from the air
std::optional<StandingEye> standIn(std::span<const glm::vec3> points, const SceneBox& box,
                                   const UpAxis& up, double unit_m, double share);

}  // namespace foci
