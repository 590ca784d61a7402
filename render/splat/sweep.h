// The tiled sweep: composites blurred splats front to back, without a list of fragments per pixel.
#pragma once

#include <cstdint>
#include <vector>

#include "render/image/frame.h"
#include "render/optics/defocus.h"
#include "render/splat/bin.h"
#include "render/splat/splat.h"

namespace foci {

/// The lens cut into sub-apertures. Each sees the scene with less blur and from its own place, so a
/// near object hides different parts of the background from each. The mean of their images is the
/// image of the lens. Only tiles in which layers cover each other in part are rendered this way.
struct SubApertures {
  /// The frame's splats, at the same indices, blurred by a sub-aperture about the lens's centre.
  const Splat* splats;
  /// By splat, the displacement for a sub-aperture at c lens radii, over radius_px_per_D c:
  /// focus_D - 1/U. For an astigmatic lens the first is along its nearest meridian, the second
  /// across it.
  const float* out_of_focus_D;
  const float* out_across_D;  ///< null: the lens is round
  const glm::mat2*
      lens_px;  ///< replaces both where directions have their own lens (`Defocus::field`)
  std::vector<glm::vec2> centres;  ///< lens radii
};

struct SweepSettings {
  glm::vec3 background;          ///< linear RGB
  Defocus defocus;               ///< the one that projected the splats
  glm::vec2 principal_px{0.0f};  ///< of the view, for `Defocus::field`
  float low_pass_px = 0.0f;  ///< standard deviation of a low-pass of the frame (`closingFactor`)
  bool depth = false;        ///< fill Frame::depth_m
  const SubApertures* sub_apertures = nullptr;  ///< null: the whole aperture only
};

/// Renders binned splats (docs/formulas.md, section 6).
///
/// Each sample has one open layer. Splats arrive front to back by their centres. A splat whose
/// z-range begins before the open layer ends joins the layer, and the ranges unite: the paper's
/// A-buffer merge by intersection, as a running union. A splat that begins behind the layer closes
/// it.
///
/// The kernels of one surface are a partition of unity, so a layer is opaque when its weights reach
/// one (kOpaqueWeight). A splat that joins later lies behind the surface, however near it is. It is
/// hidden, or, in a tile with transparent splats, starts a layer of its own.
///
/// A closed layer covers alpha = `coverageOf`(W) times its mean opacity, and its transmittance is
/// 1 - alpha. A sample that hardly any light passes takes no more splats (kHidden).
///
/// Splats are taken in batches. Blocks of 4 x 4 samples keep their open layers in registers while
/// they add the splats of a batch that they meet. SIMD with run-time dispatch, tiles by TBB.
/// @return the number of fragments: samples inside a footprint
std::uint64_t sweep(const SplatChunks& chunks, const TileLists& lists,
                    const SweepSettings& settings, Frame& frame);

/// Highway's name for the SIMD target that this machine renders with.
const char* simdTarget();

}  // namespace foci
