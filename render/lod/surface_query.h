// Distance to the nearest visible surface in a cone about the line of sight. The eye focuses there.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "render/scene/scene.h"

namespace foci {

/// The share of a surfel, or of a Gaussian, in what a cone meets; the shares sum to one.
struct SurfelShare {
  std::uint32_t surfel;  ///< or Gaussian: its number
  double share;
  /// Of the cone, on an area of the surfel: its share by its area. Of a Gaussian, whose neighbours
  /// overlap it: its outline as the renderer projects it, normalised to one and convolved with the
  /// cone's disc, at the cone's middle.
  double per_m2 = 0.0;
};

/// What a cone meets first.
struct SurfaceHit {
  double distance_m = 0.0;             ///< `SurfaceQuery::distance`
  glm::dvec3 normal{0.0};              ///< unit, towards the cone's origin; 0 for Gaussians
  std::vector<SurfelShare> surfels{};  ///< by number
};

/// Answers queries against a fixed scene, which must outlive it. Thread-safe once built.
class SurfaceQuery {
 public:
  explicit SurfaceQuery(const Scene& scene);
  explicit SurfaceQuery(const SurfelCloud& cloud);
  explicit SurfaceQuery(const GaussianCloud& cloud);
  ~SurfaceQuery();
  SurfaceQuery(SurfaceQuery&&) noexcept;
  SurfaceQuery& operator=(SurfaceQuery&&) noexcept;

  /// Distance along the ray, metres, to the first surface that covers at least `coverage` of the
  /// cone. Surfels in the cone are taken front to back and joined to surfaces by their depth
  /// ranges, as the sweep joins splats to layers. Opacity counts. The distance is the surface's
  /// coverage-weighted mean, taken in dioptres.
  ///
  /// Coverage is the sum over the surface of the surfels' kernels, convolved with the cone's disc,
  /// at the cone's middle. The kernels of an opaque surface sum to one only within 0.1, so 0.9
  /// counts as full coverage, and a larger `coverage` asks for 0.9.
  ///
  /// In a scene of Gaussians, the distance is where the opacity of all that lies in front reaches
  /// `coverage`, averaged over rays through the cone. So fainter floaters do not catch the focus. A
  /// Gaussian lies where its density along the ray is largest (gaussian_in_cone.h). What the cone
  /// meets are the Gaussians up to full coverage, by what each adds to the opacity.
  ///
  /// The depth range of a surfel is two standard deviations along the ray to either side, and at
  /// least one sigma (its longer axis). Ranges that overlap form one surface. A surfel whose range
  /// begins nearer than 1 mm is ignored, because the eye sits there.
  /// @param direction       unit length
  /// @param half_angle_rad  > 0, below pi/4
  /// @param coverage        0 < coverage <= 1
  /// @return absent if no surface covers that much of the cone
  std::optional<double> distance(const glm::dvec3& origin_m, const glm::dvec3& direction,
                                 double half_angle_rad, double coverage) const;

  /// The same with the surface itself.
  std::optional<SurfaceHit> hit(const glm::dvec3& origin_m, const glm::dvec3& direction,
                                double half_angle_rad, double coverage) const;

  class Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace foci
