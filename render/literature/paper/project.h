// Projects surfels and the nodes of a hierarchy to the paper's splats (Eq. 5 to 12).
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>

#include "render/literature/paper/splat.h"
#include "render/optics/defocus.h"
#include "render/optics/view.h"

namespace foci {

/// Surfels or nodes to project, as arrays of `count` elements.
struct PaperSurfels {
  std::size_t count = 0;
  const glm::vec3* position_m = nullptr;
  const glm::vec3* axis_u_m = nullptr;  ///< V_r = axis_u axis_u' + axis_v axis_v'
  const glm::vec3* axis_v_m = nullptr;
  /// V_l = spread_u spread_u' + spread_v spread_v', in the same plane; null: no low-pass filter.
  const glm::vec3* spread_u_m = nullptr;
  const glm::vec3* spread_v_m = nullptr;
  const glm::vec3* color = nullptr;
  const float* opacity = nullptr;  ///< null: all 1
  const float* area_m2 = nullptr;
};

/// Projects the surfels. Drops a surfel whose centre is nearer than `view.near_m` along the axis,
/// and a surfel whose footprint lies outside the image. Also drops surfels without projected area,
/// and surfels with values that are not finite.
///   W = J V_r J' + I + circumellipse(J V_l J', V_C),  V_C = C^2 / (2 ln 4) I      (Eq. 11, 12)
/// Where pixels are oblong, the circle of confusion is an ellipse on the image. The circumellipse
/// is then taken in scaled coordinates in which it is a circle.
///
/// The z-range holds the depths, along the axis, that the surfel's plane spans under the blurred
/// basis function (section 6.4).
///   z +- sqrt(2c (u_z^2 + v_z^2 + s^2 sin^2))
/// u_z and v_z are the changes of the depth along the axes, and sin is the sine of the plane's
/// tilt. s^2 is the variance of prefilter and V_C, brought back to the surfel by (z / f)^2.
///
/// The paper does not say how it extrapolates. Another reading takes the plane's depth under the
/// footprint on the screen, which grows without bound where a surfel is seen edge on. We take the
/// reading that errs less.
/// @param splats, tiles  room for `surfels.count`
/// @return the number of splats, which come in the order of the surfels
std::uint32_t projectPaper(const PaperSurfels& surfels, const View& view, const Defocus& defocus,
                           const Lighting& lighting, PaperSplat* splats, PaperSplatTiles* tiles);

}  // namespace foci
