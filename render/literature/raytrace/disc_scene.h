// Surfels on the pinhole image, and which of them a pixel sees through a point of the lens, found
// by Embree.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "render/literature/raytrace/embree_scene.h"
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
std::vector<SeenSurfel> seenSurfels(const SurfelCloud& cloud, const View& view, DistanceAlong along,
                                    const Lighting& lighting);

struct Hit {
  std::uint32_t surfel;
  float weight;      ///< of the splat at the pixel
  glm::vec2 offset;  ///< of the splat's centre from the pixel's, in radii of its narrower side
};

/// The surfels as discs in image space (x px, y px, vergence v), and the rays through them.
///
/// A point at x px on the pinhole image and v dioptres away is seen through the lens point l at
///   x + r l (P - v)        (r: radius_px_per_D, P: focus)
/// So the points that a pixel sees through l lie on a straight line in (x, y, v). This holds for a
/// camera and for an eye, which measures distances along the line of sight. All lines of a pixel
/// meet at v = P. An astigmatic lens, with the astigmatism J, shifts each line by r J l, whatever
/// v.
///
/// In this space the footprint of a splat, prefilter included, is a flat ellipse at the splat's
/// vergence. An oriented disc across v contains the ellipse. The disc works at a grazing angle too,
/// where a disc in the plane of the surfel would not contain the prefilter.
class DiscScene {
 public:
  /// @param surfels, defocus  must outlive the scene
  /// Throws std::runtime_error where Embree fails.
  DiscScene(const std::vector<SeenSurfel>& surfels, const Defocus& defocus);

  /// The surfels that the pixel centre sees through a point of the lens (in lens radii), in the
  /// order of `surfels`.
  void trace(const glm::vec2& pixel, const glm::vec2& lens, std::vector<Hit>& hits) const;

 private:
  glm::vec4 discOf(const SeenSurfel& surfel) const;

  const std::vector<SeenSurfel>& surfels_;
  const Defocus& defocus_;
  float px_per_D_ = 1.0f;
  float nearest_ = 0.0f, furthest_ = 0.0f;
  EmbreeScene scene_;
};

}  // namespace foci
