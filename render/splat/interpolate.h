// Interpolates a tile's samples to the pixels of the frame.
#pragma once

#include "render/image/frame.h"
#include "render/splat/bin.h"

namespace foci {

/// Writes the tile's pixels that lie on the frame. Samples one pixel apart are copied. Others are
/// interpolated by cubics (Catmull and Rom 1974), which reproduce linear ramps.
/// @param rgba     rows of tile.samplesWithApron() samples
/// @param depth_m  depths times coverage, in the same layout; null: none
void interpolateTile(const Tile& tile, const glm::vec4* rgba, const float* depth_m, Frame& frame);

}  // namespace foci
