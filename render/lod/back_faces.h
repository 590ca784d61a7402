// Back faces that no point of the lens sees, because the near side of a closed body hides them.
#pragma once

#include <cstdint>
#include <vector>

#include "render/optics/defocus.h"
#include "render/optics/view.h"
#include "render/scene/surfel_cloud.h"

namespace foci {

/// By number, 1 for each body that the whole lens sees from outside its box; [0] is 0. Empty
/// without bodies.
std::vector<std::uint8_t> bodiesFromOutside(const ClosedBodies& bodies, const View& view,
                                            const Defocus& defocus);

/// The lens's radius in metres. A plane through p with the normal n shows its back to the whole
/// lens if dot(n, p - eye) is larger.
float lensRadius_m(const View& view, const Defocus& defocus);

/// Where the surfels below a node face.
struct Facing {
  std::uint16_t body;  ///< of them all; 0: none is on a closed body
  /// Cosine of the largest angle between a surfel's normal and the node's mean normal, in 65535ths;
  /// 0: a right angle or more.
  std::uint16_t cos_cone;
  static constexpr std::uint16_t kSeveral = 65535;  ///< as body: they differ
};

/// Which sides of the surfels below a node the lens sees.
enum class FacingSide { backs, fronts, both };

/// @param normal    the node's mean normal
/// @param p         the node's place from the eye, metres
/// @param radius_m  of a sphere that holds the surfels
FacingSide sideOf(const Facing& facing, const glm::vec3& normal, const glm::vec3& p, float radius_m,
                  float lens_m);

}  // namespace foci
