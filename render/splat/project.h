// Surfels to splats: EWA projection with the blur of each splat (Eq. 5 to 11).
#pragma once

#include "render/lod/cut.h"
#include "render/optics/acuity.h"
#include "render/optics/defocus.h"
#include "render/optics/view.h"
#include "render/scene/surfel_cloud.h"
#include "render/splat/splat.h"

namespace foci {

/// How the circle of confusion enters a splat of unblurred variance V = J V_r J' + I.
enum class BlurKernel {
  disc,      ///< variance V + C^2/4 I and the kurtosis of disc * Gaussian (kernel.h)
  gaussian,  ///< variance V + 0.36067 C^2 I (Eq. 11), bell-shaped
};

/// What is rendered of the lens, and how. By default all of it at once.
struct Projection {
  BlurKernel kernel = BlurKernel::disc;
  /// Centre of the part of the lens that is looked through, in lens radii. A point U away moves on
  /// the image by radius_px_per_D lens (focus_D - 1/U): its place seen from there, with the focus
  /// kept.
  glm::vec2 lens{0.0f};
  float aperture = 1.0f;  ///< radius of that part over the lens's, 0 (a pinhole) to 1
  /// Radius over the lens's of the parts that splats are given for besides, see `LensParts`; 0:
  /// none.
  float part_aperture = 0.0f;
  Acuity acuity = {};  ///< how wide the prefilter is
  int margin_px = 0;   ///< splats are kept that touch the image or this much about it
  float shading =
      0.0f;  ///< 0 to 1: how much of the colour falls off with the cosine to the line of sight
};

/// Projects every surfel and drops those that render nothing: nearer than `view.near_m` along the
/// axis, outside the image, with a projected area of zero, or not finite. The kernel's variance
/// on the image is W = J V_r J' + V_h + C^2/4 I, V_h the prefilter of `acuity`, I by default, its
/// kurtosis that of a disc of radius C convolved with the unblurred splat (kernel.h). SIMD with
/// run-time dispatch, threads by TBB; chunk contents do not depend on either but for rounding.
void projectSurfels(const SurfelCloud& cloud, const View& view, const Defocus& defocus,
                    const Projection& projection, SplatChunks& chunks);

/// Projects a cut of the tree likewise. Of a node, what merging added to its variance V is rendered
/// once in its kernel or, where a texture is finer than the node, lies in its place: W = own V + I
/// + V_C, own the surfels' share of V.
void projectCut(const MomentTree& tree, const Cut& cut, const View& view, const Defocus& defocus,
                const Projection& projection, SplatChunks& chunks);

}  // namespace foci
