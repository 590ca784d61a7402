// The A-buffer of the paper's section 6.4 (Carpenter 1984; z-ranges by Rasanen 2002). Private to
// `paper` and `paper-lod`.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include "render/image/frame.h"
#include "render/methods/paper_splat.h"
#include "render/methods/paper_tiles.h"

namespace foci {

/// Draws binned splats over `background` (linear RGB). Every pixel has a list of fragments, each
/// with a z-range. A new fragment is merged with all of them whose ranges meet its own: weights and
/// colours add, ranges unite, so that a list's ranges never meet and the order of the splats does
/// not matter. At the end a pixel's fragments are composited front to back: each covers alpha =
/// min(1, W) times its mean opacity, with its colour divided by W where W > 1.
///
/// A tile at a time: the memory is that of one tile's lists a thread. Lists are chained in nodes of
/// 4x4 pixels, one SIMD step wide; SIMD with run-time dispatch, tiles in parallel.
/// @param transparent  some splat's opacity is below 1
/// @param depth        fill `frame.depth_m`
/// @return the number of fragments: pixel centres of the image inside a cut ellipse
std::uint64_t renderABuffer(const PaperSplats& splats, const PaperTileLists& lists,
                            const glm::vec3& background, bool transparent, bool depth,
                            Frame& frame);

}  // namespace foci
