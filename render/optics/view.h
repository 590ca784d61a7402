// The eye's or camera's pose and its projection to the image. All images share these conventions.
// The eye looks along -z, with x to the right and y up. The image origin is the top-left corner,
// with x to the right and y down. Pixel centres lie at +0.5.
#pragma once

#include <glm/glm.hpp>

namespace foci {

struct View {
  glm::mat4 eye_from_world{1.0f};
  glm::ivec2 size_px{0, 0};
  /// Pixels for a tangent of 1, along x and y; screens may have oblong pixels.
  glm::vec2 focal_px{0.0f};
  glm::vec2 principal_px{0.0f};  ///< image point of the -z axis
  float near_m = 0.01f;          ///< nothing nearer along the axis is rendered
  bool operator==(const View&) const = default;
};

/// How a view of a scene is lit.
struct Lighting {
  glm::vec3 background{0.0f};  ///< linear RGB behind everything
  /// Lambert's shading, 0 to 1: how much of the colour falls off with the cosine of the angle
  /// between the surfel's normal and the line of sight.
  float shading = 0.0f;
  bool operator==(const Lighting&) const = default;

  /// Share of the colour that is seen. @param cosine  0 to 1
  float shade(float cosine) const { return 1.0f + shading * (cosine - 1.0f); }
};

/// Rigid transform of an eye at `position_m` that looks at `target_m`, `up` roughly upwards.
/// The three must not be collinear (asserted).
glm::mat4 eyeFromWorld(const glm::vec3& position_m, const glm::vec3& target_m, const glm::vec3& up);

/// View through a screen that the eye faces. The frustum is the screen's own:
/// focal_px = d_s R (docs/formulas.md, section 1). `size_px` is the size of the image, which may be
/// coarser than the screen.
/// @param faced_m  from the screen's centre to the point that the eye faces; x right, y up
View viewThroughScreen(const glm::mat4& eye_from_world, const glm::ivec2& size_px,
                       const glm::dvec2& screen_size_m, double distance_m,
                       const glm::dvec2& faced_m = glm::dvec2(0.0));

/// View of a pinhole camera with a vertical field of view, square pixels.
View viewOfCamera(const glm::mat4& eye_from_world, const glm::ivec2& size_px, double fov_y_rad);

/// Image point of a point in the eye frame (z < 0). Pixels.
inline glm::vec2 project(const View& view, const glm::vec3& p_eye) {
  return view.principal_px + view.focal_px * glm::vec2(p_eye.x, -p_eye.y) / -p_eye.z;
}

/// Unit direction in the eye frame through an image point; the inverse of `project`.
glm::dvec3 directionThrough(const View& view, const glm::dvec2& point_px);

}  // namespace foci
