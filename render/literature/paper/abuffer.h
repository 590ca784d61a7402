// The A-buffer of the paper's section 6.4: Carpenter, The A-buffer, an Antialiased Hidden Surface
// Method, 1984, with the z-ranges of Rasanen 2002.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include "render/image/frame.h"
#include "render/literature/paper/splat.h"

namespace foci {

/// Renders binned splats over `background` (linear RGB). Every pixel has a list of fragments, each
/// with a z-range. A new fragment merges with all fragments whose ranges meet its own: weights and
/// colours add, and ranges unite. So the ranges in a list never meet, and the order of the splats
/// does not matter. At the end each pixel's fragments are composited front to back. A fragment
/// covers alpha = min(1, W) times its mean opacity; where W > 1, its colour is divided by W.
///
/// Each thread renders one tile at a time and holds the lists of that tile only. SIMD with run-time
/// dispatch.
/// @param transparent  some splat's opacity is below 1
/// @param depth        fill `frame.depth_m`
/// @return the number of fragments: pixel centres of the image inside a truncated ellipse
std::uint64_t renderABuffer(const PaperSplats& splats, const PaperTileLists& lists,
                            const glm::vec3& background, bool transparent, bool depth,
                            Frame& frame);

}  // namespace foci
