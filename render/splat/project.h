// Projects surfels to splats: EWA splatting with the blur of each splat (Eq. 5 to 11 of the paper,
// docs/formulas.md, sections 2 and 3).
#pragma once

#include "render/lod/cut.h"
#include "render/optics/acuity.h"
#include "render/optics/defocus.h"
#include "render/optics/view.h"
#include "render/scene/surfel_cloud.h"
#include "render/splat/splat.h"

namespace foci {

/// How the circle of confusion, of radius C, blurs a splat of unblurred variance V = J V_r J' + I.
enum class BlurKernel {
  disc,      ///< variance V + C^2/4 I and the kurtosis of disc * Gaussian (kernel.h)
  gaussian,  ///< variance V + 0.36067 C^2 I (Eq. 11), bell-shaped
};

/// How to project. By default through the whole aperture.
struct Projection {
  BlurKernel kernel = BlurKernel::disc;
  /// Centre of the aperture that the splats are seen through, in lens radii. The focus is kept, so
  /// a point at the distance U moves on the image by radius_px_per_D lens (focus_D - 1/U).
  glm::vec2 lens{0.0f};
  float aperture = 1.0f;  ///< its radius over the lens's, 0 (a pinhole) to 1
  /// Radius of a sub-aperture over the lens's; 0: no splats for sub-apertures (`SubApertures`).
  float sub_aperture = 0.0f;
  Acuity acuity = {};  ///< width of the prefilter
  int margin_px = 0;   ///< keeps splats that reach the image or this margin about it
  Lighting lighting = {};
  bool operator==(const Projection&) const = default;
};

/// Projects every surfel. Drops a surfel that is nearer than `view.near_m` along the axis, outside
/// the image, of no projected area, or not finite.
///
/// The kernel's variance on the image is W = J V_r J' + V_h + C^2/4 I. V_h is the prefilter of
/// `acuity`, I by default. The kernel's kurtosis is that of a disc of radius C convolved with the
/// unblurred splat (kernel.h). SIMD with run-time dispatch, threads by TBB. The contents of chunks
/// depend on the SIMD width by rounding only, and on the number of threads not at all.
void projectSurfels(const SurfelCloud& cloud, const View& view, const Defocus& defocus,
                    const Projection& projection, SplatChunks& chunks);

/// Projects an LOD cut. `own` is the surfels' share of a node's variance V; merging added the rest.
/// The node's blur, or a texture finer than the node, already contains the rest, so the node is not
/// low-passed twice (docs/formulas.md, section 4).
///
///   W = own J V J' + V_h + C^2/4 I.
void projectCut(const MomentTree& tree, const Cut& cut, const View& view, const Defocus& defocus,
                const Projection& projection, SplatChunks& chunks);

}  // namespace foci
