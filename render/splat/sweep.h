// The tiled, streamed sweep: splats blurred before the image is formed, composited without lists.
#pragma once

#include "render/image/frame.h"
#include "render/splat/bin.h"
#include "render/splat/splat.h"

namespace foci {

/// Draws binned splats over `background` (linear RGB). Per pixel one layer is open at a time.
/// Splats come front to back by the near end of their z-range: one that begins before the open
/// layer ends joins it, weights and colours add and the ranges unite (the A-buffer's merge by
/// intersection, section 6.4, as a running union); one that begins behind it closes it. A closed
/// layer covers alpha = min(1, W) times its mean opacity and lets 1 - alpha of what follows
/// through. SIMD with run-time dispatch, tiles by TBB.
/// @param transparent  some splat's opacity is below 1
/// @param depth        fill `frame.depth_m`
/// @return the number of fragments: pixel centres inside a footprint
std::uint64_t sweep(const SplatChunks& chunks, const TileLists& lists, const glm::vec3& background,
                    bool transparent, bool depth, Frame& frame);

/// The SIMD target that rendering runs on here, as Highway names it.
const char* simdTarget();

}  // namespace foci
