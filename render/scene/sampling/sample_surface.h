// Surfels on parametric surfaces, as fine as an eye at a given place can use. Private to the
// built-in scenes.
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
  /// What light makes of the paint, once a surfel; default: nothing.
  std::function<glm::vec3(const SurfacePoint&, const glm::vec3& paint)> light = {};
  std::function<bool(const SurfacePoint&)> keep = {};  ///< default: everything
  float opacity = 1.0f;
  bool two_sided = false;  ///< else the side turned away is sampled coarsely
};

/// For whom a scene is sampled: one surfel every `step_rad` as seen from `eye_m`; coarser outside
/// the view, whose half width and height are tangents along `right` and `up`, and on sides turned
/// away.
struct SampledFor {
  glm::vec3 eye_m;
  glm::vec3 right, up, forward;
  glm::vec2 half_view;
  float step_rad;
};

/// Appends rows of surfels: equal steps along each row and from row to row, as the eye sees them,
/// so that the kernels sum to one. Deterministic at any number of threads.
void appendSurface(SurfelCloud& cloud, const ParametricSurface& surface,
                   const SampledFor& audience);

}  // namespace foci
