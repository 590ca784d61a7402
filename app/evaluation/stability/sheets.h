// Rectangles that the scenes of the stability suite consist of. Methods get them as surfels. The
// reference traces rays through the lens to the rectangles themselves.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <vector>

#include "render/image/frame.h"
#include "render/methods/method.h"
#include "render/optics/view.h"
#include "render/scene/surfel_cloud.h"

namespace foci::stability {

inline constexpr float kFocal_px = 300.0f;

/// A rectangle around `centre_m`, in the eye's coordinates.
struct Sheet {
  glm::vec3 centre_m{0.0f};
  glm::vec2 size_m{1.0f};
  glm::vec3 across{1.0f, 0.0f, 0.0f}, up{0.0f, 1.0f, 0.0f};  ///< unit, perpendicular
  std::function<glm::vec3(const glm::vec2&)> color;          ///< at a point of the sheet, m
  float opacity = 1.0f;
};

std::function<glm::vec3(const glm::vec2&)> plain(const glm::vec3& color);

/// A texture with large and small features. It does not depend on the sampling.
std::function<glm::vec3(const glm::vec2&)> textured(const glm::vec3& color, float feature_m);

/// Adds surfels that are one pixel apart at the sheet's centre.
/// @param misled_deg  angle between the surfels' normals and the true normal; the directions are
///                    random
void addSurfels(SurfelCloud& cloud, const Sheet& sheet, float misled_deg = 0.0f);

/// The sheets through a thin lens. Each ray meets its sheets exactly, front to back, so surfaces
/// hide each other however close they are. A ray through the pixel x and the point l of the lens
/// (in radii) is
///   p(z) = L (1 - z P) + z d(x),   L = l radius_px_per_D / focal_px.
/// P is the focus in dioptres. d is the direction through x with d_z = -1, so all rays of a pixel
/// meet at z = 1/P.
///
/// The frame has the splats' own sampling: a prefilter of 1 px, and outlines and textures convolved
/// with Gaussians of `kSigmaPerSpacing` spacings, like the surfels' kernels. A comparison with it
/// shows the error of lens and visibility without the error of sampling.
/// @param settings  with blur by depth along the axis (asserted)
/// @param samples   of the lens, for each of the four points of a pixel, > 0. With 100 samples the
///                  noise is about 60 dB below white.
Frame exactFrame(const std::vector<Sheet>& sheets, const View& view, const RenderSettings& settings,
                 int samples);

}  // namespace foci::stability
