// Rectangles to build stability scenes of: as surfels, which is what methods are given, and as what
// they are, seen through the lens ray by ray, which is what methods are held against.
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

/// A rectangle through `centre_m`, in the eye's frame.
struct Sheet {
  glm::vec3 centre_m{0.0f};
  glm::vec2 size_m{1.0f};
  glm::vec3 across{1.0f, 0.0f, 0.0f}, up{0.0f, 1.0f, 0.0f};  ///< unit, perpendicular
  std::function<glm::vec3(const glm::vec2&)> color;          ///< by place on the sheet, m
  float opacity = 1.0f;
};

std::function<glm::vec3(const glm::vec2&)> plain(const glm::vec3& color);

/// Large and small features, the same at any sampling.
std::function<glm::vec3(const glm::vec2&)> textured(const glm::vec3& color, float feature_m);

/// Surfels a pixel apart, as the sheet's centre is seen.
/// @param misled_deg  their normals are off by so much, each in a direction of its own
void addSurfels(SurfelCloud& cloud, const Sheet& sheet, float misled_deg = 0.0f);

/// The sheets themselves through a thin lens: each ray meets its sheets exactly, front to back, so
/// that surfaces hide each other however near they are. For the pixel x and the point l of the lens
/// (radii), a ray is
///   p(z) = L (1 - z P) + z d(x),   L = l radius_px_per_D / focal_px,
/// P the focus in dioptres, d the direction through x with d_z = -1 (so that all rays of a pixel
/// meet at z = 1/P). Seen through the splats' prefilter, a Gaussian of 1 px; outlines and textures
/// are those that the surfels' own kernels make of them, Gaussians of `kSigmaPerSpacing` spacings,
/// so that the frame tells the error of lens and visibility from that of sampling.
/// @param settings  with blur by depth along the axis (asserted)
/// @param samples   of the lens, at each of four points a pixel, > 0. With 100 the noise is about
///                  60 dB below white.
Frame exactFrame(const std::vector<Sheet>& sheets, const View& view, const RenderSettings& settings,
                 int samples);

}  // namespace foci::stability
