// Surfels on the pinhole image, as the ray tracer needs them: with their vergence, so that each
// lens point can move them.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "render/optics/defocus.h"
#include "render/optics/view.h"
#include "render/scene/surfel_cloud.h"

namespace foci {

/// A surfel on the pinhole image. Through the lens point l, in pixels a dioptre, the centre moves
/// by l (P - v), and an axis moves by l times the change of vergence along it.
struct SeenSurfel {
  glm::vec2 center_px;
  glm::vec2 u_px, v_px;  ///< axes: one standard deviation
  float u_D, v_D;        ///< change of the vergence along the axes
  float vergence_D;
  float area_per_axes;  ///< weight over |u x v|
  glm::vec3 color;      ///< shaded, times opacity
  float opacity;
  bool back_facing;
  float distance_m, near_m, far_m;
};

/// The surfels in front of the eye whose values are finite, from the nearest to the farthest.
/// Surfels of equal distance keep their order.
/// @param shading  as in `RenderSettings`
std::vector<SeenSurfel> seenSurfels(const SurfelCloud& cloud, const View& view, DistanceAlong along,
                                    float shading);

}  // namespace foci
