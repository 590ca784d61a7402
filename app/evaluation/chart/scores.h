// The errors of a frame against a case's reference.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "app/evaluation/cells.h"
#include "render/image/frame.h"
#include "render/optics/defocus.h"

namespace foci {

/// What frames are compared with.
struct Compared {
  const Frame* reference = nullptr;
  std::vector<glm::vec3> lab{};      ///< `labOf` the reference
  std::vector<std::uint8_t> band{};  ///< the silhouettes
};

/// @param reference  must outlive the result
/// @param pinhole    a frame without blur, with depth
Compared comparedWith(const Frame& reference, const Frame& pinhole, const Defocus& lens);

/// Without what `auto` states.
ChartErrors scoresOf(const Frame& frame, const Compared& with);

}  // namespace foci
