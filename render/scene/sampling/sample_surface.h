// Samples surfels on parametric surfaces, at the density that an eye at a given place resolves.
// Private to the built-in scenes.
#pragma once

#include <functional>
#include <glm/glm.hpp>

#include "render/scene/surfel_cloud.h"

namespace foci {

struct SurfacePoint {
  glm::vec2 uv;
  glm::vec3 p_world;
  glm::vec3 normal;  ///< unit length, along cross(dp/du, dp/dv)
};

/// A patch over the unit square.
struct ParametricSurface {
  std::function<glm::vec3(glm::vec2)> at;
  std::function<glm::vec3(const SurfacePoint&)>
      paint;  ///< linear RGB, averaged over a surfel's cell
  /// Lights the paint of a surfel; default: leaves the paint.
  std::function<glm::vec3(const SurfacePoint&, const glm::vec3& paint)> light = {};
  std::function<bool(const SurfacePoint&)> keep = {};  ///< default: everything
  float opacity = 1.0f;
  bool two_sided = false;  ///< else a back-facing side is sampled coarsely
};

/// The eye that a scene is sampled for, at one surfel every `step_rad` from `eye_m`. Sampling is
/// coarser outside the view and on back-facing sides. `half_view` is the tangents of the view's
/// half width and height, along `right` and `up`.
struct SampledFor {
  glm::vec3 eye_m;
  glm::vec3 right, up, forward;
  glm::vec2 half_view;
  float step_rad;
};

/// Appends rows of surfels. Steps along a row and from row to row are equal for the eye, so the
/// kernels sum to one. The result does not depend on the number of threads.
void appendSurface(SurfelCloud& cloud, const ParametricSurface& surface,
                   const SampledFor& audience);

}  // namespace foci
