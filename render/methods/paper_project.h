// Surfels and nodes of a hierarchy to the paper's splats (Eq. 5 to 12). Private to `paper` and
// `paper-lod`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>

#include "render/methods/paper_splat.h"
#include "render/optics/defocus.h"
#include "render/optics/view.h"

namespace foci {

/// What is projected, as arrays of `count`.
struct PaperSurfels {
  std::size_t count = 0;
  const glm::vec3* position_m = nullptr;
  const glm::vec3* axis_u_m = nullptr;  ///< V_r = axis_u axis_u' + axis_v axis_v'
  const glm::vec3* axis_v_m = nullptr;
  const glm::vec3* spread_u_m = nullptr;  ///< V_l likewise, in the same plane; null: level 0
  const glm::vec3* spread_v_m = nullptr;
  const glm::vec3* color = nullptr;
  const float* opacity = nullptr;  ///< null: all 1
  const float* area_m2 = nullptr;
};

/// Projects and drops what renders nothing: centres nearer than `view.near_m` along the axis,
/// outside the image, with a projected area of zero, or not finite.
///   W = J V_r J' + I + circumellipse(J V_l J', V_C),  V_C = C^2 / (2 ln 4) I      (Eq. 11, 12)
/// Where pixels are oblong the circle of confusion is an ellipse, and circumellipse is taken where
/// it is a circle.
///
/// The z-range is the depth along the axis that the surfel's plane spans under the blurred basis
/// function in camera space (section 6.4): with s^2 = (z / f)^2 variance of prefilter and V_C
/// brought back to the surfel, sin the sine of the plane's tilt, and u_z, v_z how the axes change
/// the depth,
///   z +- sqrt(2c (u_z^2 + v_z^2 + s^2 sin^2)).
/// The paper does not say how it extrapolates. Of the two readings this is the one that errs less:
/// the plane's depth under the footprint on the screen grows without bound where a surfel is seen
/// edge on.
/// @param splats, tiles  room for `surfels.count`
/// @return how many came out, in the order of the surfels
std::uint32_t projectPaper(const PaperSurfels& surfels, const View& view, const Defocus& defocus,
                           float shading, PaperSplat* splats, PaperSplatTiles* tiles);

}  // namespace foci
