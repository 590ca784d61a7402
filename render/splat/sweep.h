// The tiled, streamed sweep: splats blurred before the image is formed, composited without lists.
#pragma once

#include "render/image/frame.h"
#include "render/optics/defocus.h"
#include "render/splat/bin.h"
#include "render/splat/splat.h"

namespace foci {

/// The lens in parts, to tell what it sees around a surface: each part's view has the blur of that
/// part only, and all are averaged. Drawn so are the tiles in which layers cover each other in
/// part.
struct LensParts {
  /// The frame's splats again, in the same places, blurred by a part about the lens's centre.
  const Splat* splats;
  /// By splat, focus_D - 1/U: seen from a part at c lens radii it moves by radius_px_per_D c times
  /// that. Of an astigmatic lens along its nearest meridian and across it.
  const float* out_of_focus_D;
  const float* out_across_D;  ///< null: the lens is round
  std::vector<glm::vec2> centres;
};

struct SweepSettings {
  glm::vec3 background;              ///< linear RGB
  Defocus defocus;                   ///< as the splats were projected with
  bool transparent = false;          ///< some splat's opacity is below 1
  bool depth = false;                ///< fill Frame::depth_m
  const LensParts* parts = nullptr;  ///< null: the lens as a whole
};

/// Draws binned splats. Per sample one layer is open at a time. Splats come front to back by their
/// centres: one whose z-range begins before the open layer ends joins it, and the ranges unite (the
/// A-buffer's merge by intersection, section 6.4, as a running union); one that begins behind it
/// closes it. The kernels of one surface sum to one: weights and colours add until they have, and
/// what joins later lies behind, however near: it is hidden, or, where the scene is transparent,
/// makes a layer of its own. A closed layer covers alpha = `coverageOf`(W) times its mean opacity
/// and lets 1 - alpha of what follows through; where hardly any light passes, nothing more is
/// rendered. Splats are taken in batches, and blocks of 4 x 4 samples keep their open layers in
/// registers while they add those of a batch that they meet. SIMD with run-time dispatch, tiles by
/// TBB.
/// @return the number of fragments: samples inside a footprint
std::uint64_t sweep(const SplatChunks& chunks, const TileLists& lists,
                    const SweepSettings& settings, Frame& frame);

/// The SIMD target that rendering runs on here, as Highway names it.
const char* simdTarget();

}  // namespace foci
