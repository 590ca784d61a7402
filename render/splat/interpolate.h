// Interpolates a tile's samples to the pixels of the frame.
#pragma once

#include <array>

#include "render/image/frame.h"
#include "render/splat/bin.h"

namespace foci {

/// Weights of four samples in a row, `t` of the way from the second to the third (Catmull and Rom
/// 1974).
inline std::array<float, 4> catmullRom(float t) {
  return {0.5f * t * (-1.0f + t * (2.0f - t)), 0.5f * (2.0f + t * t * (-5.0f + 3.0f * t)),
          0.5f * t * (1.0f + t * (4.0f - 3.0f * t)), 0.5f * t * t * (t - 1.0f)};
}

/// Writes the tile's pixels that lie on the frame. Samples one pixel apart are copied. Others are
/// interpolated by these cubics, which reproduce linear ramps.
/// @param rgba     rows of tile.samplesWithApron() samples
/// @param depth_m  depths times coverage, in the same layout; null: none
/// @param weight   over what the frame holds; 1: in its place
void interpolateTile(const Tile& tile, const glm::vec4* rgba, const float* depth_m, float weight,
                     Frame& frame);

}  // namespace foci
