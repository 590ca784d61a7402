// A Gaussian of the scene as the lens sees it on the image (EWA volume splatting: Zwicker et al.,
// EWA Splatting, 2002; Kerbl et al. 2023).
#pragma once

#include <cstddef>
#include <vector>

#include "render/gaussians/gaussian_cut.h"
#include "render/optics/defocus.h"
#include "render/optics/view.h"
#include "render/scene/gaussian_cloud.h"
#include "render/splat/splat.h"

namespace foci {

/// Variance of the low-pass that rasterisers of captured scenes add to each Gaussian, px^2. Scenes
/// are trained with it (Kerbl et al. 2023).
inline constexpr float kLowPass_px2 = 0.3f;

/// Largest alpha of a Gaussian at a pixel, and the transmittance at which a pixel is opaque, of the
/// rasteriser that scenes are trained with (Kerbl et al. 2023).
inline constexpr float kMaxAlphaOfGaussian = 0.99f;
inline constexpr float kOpaqueTransmittance = 1e-4f;

/// The local affine approximation holds near the image. Beyond this multiple of the field of view,
/// it is taken from there (Kerbl et al. 2023).
inline constexpr float kFieldMargin = 1.3f;

/// Standard deviation of a lens's mean view, as `TileLists` chooses samples by it, over the blur
/// radius: samples are up to C / 2.3 apart. A disc has 1/2. On two captures that are blurred
/// everywhere, the images are then as close to 150 pinholes as with samples a pixel apart.
inline constexpr float kSigmaPerBlur = 0.3f;

/// Vergences and distances of a Gaussian are clamped to this many standard deviations.
inline constexpr float kVergenceReach = 3.0f;

/// Largest exponent, to base 2, of a Gaussian's peak: it stays finite.
inline constexpr float kMaxPeakExponent = 60.0f;

/// From the lens point p, on the unit disc, a point at the vergence 1/U appears displaced by
///   R o ((F - I/U) p),   R = radius_px_per_D, F - I/U = [m_xx m_xy; m_xy m_yy]    (defocus.h).
/// The displacement varies within a Gaussian that is deep. To first order this shears it: with the
/// gradient h of the vergence, the Jacobian J of the projection, and the covariance S,
///   V_p = J S J' - a s' - s a' + e a a',   a = R o p,  s = J S h,  e = h' S h.
/// At the offset d on the image, the mean vergence is 1/U + d' V_p^-1 (s - e a).
struct ProjectedGaussian {
  float x_px, y_px;        ///< centre, from the middle of the lens
  float vxx, vxy, vyy;     ///< J S J' and the low-pass, px^2
  float sx, sy, e;         ///< px D, px D, D^2
  float off_D;             ///< F - 1/U, without astigmatism
  float opacity;           ///< at the centre; above 1: a flat top (`peakOf`)
  float cut;               ///< squared standard deviations at which it falls to kMinAlpha
  float red, green, blue;  ///< display values
  float distance_m;        ///< U
};
static_assert(sizeof(ProjectedGaussian) == 60);

/// Sub-apertures of one size, as splats need to know them. In lens radii.
struct SubApertureSize {
  float max_radius = 0.0f;  ///< largest distance of a centre from the middle of the lens
  float aperture = 0.0f;    ///< radius of each; 0: pinholes
};

/// Gaussians on the image, in chunks as TileLists takes them.
struct ProjectedGaussians {
  std::vector<ProjectedGaussian> gaussians;
  SplatChunks chunks;  ///< without `splats`

  std::size_t total() const { return chunks.total(); }
};

/// Projects all Gaussians that a sub-aperture of any of the `sizes` may show. The order in a chunk
/// is that of the scene.
/// @param cut  replaces the scene, nodes first; null: all Gaussians
void projectGaussians(const GaussianCloud& cloud, const GaussianCut* cut, const View& view,
                      const Defocus& defocus, const std::vector<SubApertureSize>& sizes,
                      ProjectedGaussians& out);

}  // namespace foci
