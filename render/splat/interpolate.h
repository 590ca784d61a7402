// From a tile's samples to the pixels of the frame.
#pragma once

#include "render/image/frame.h"
#include "render/splat/bin.h"

namespace foci {

/// Writes the tile's pixels that lie on the frame: samples as they are where a step is one pixel,
/// else cubic interpolation between them (Catmull and Rom 1974), which keeps straight lines
/// straight.
/// @param rgba     rows of tile.samplesWithApron() samples
/// @param depth_m  likewise, times the coverage; null: none
void interpolateTile(const Tile& tile, const glm::vec4* rgba, const float* depth_m, Frame& frame);

}  // namespace foci
