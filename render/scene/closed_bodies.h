// Closed bodies: opaque solids whose surface has no hole. From outside, the near side hides the far
// side, so nothing that faces away from the eye need be rendered (render/lod/back_faces.h).
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "base/mapped_vector.h"

namespace foci {

struct SurfelCloud;

/// The closed bodies of a cloud, numbered from 1.
struct ClosedBodies {
  struct Box {
    glm::vec3 low_m, high_m;
  };
  MappedVector<std::uint16_t> of_surfel;  ///< 0: none. Empty: no surfel is on a closed body
  std::vector<Box> boxes;                 ///< by number; [0] is unused. Empty where `of_surfel` is
};

/// Largest number of a body. Further surfaces count as open.
inline constexpr std::uint16_t kMaxBodies = 65534;

/// Makes the boxes of `cloud.bodies` from the surfels' extents to three standard deviations. Drops
/// bodies of which a surfel is not opaque.
void completeBodies(SurfelCloud& cloud);

}  // namespace foci
