// Distance to the nearest visible surface in a cone: what the eye focuses on.
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <optional>

#include "render/scene/surfel_cloud.h"

namespace foci {

/// Answers queries against a fixed cloud, which must outlive it. Thread-safe once built.
class SurfaceQuery {
 public:
  explicit SurfaceQuery(const SurfelCloud& cloud);
  ~SurfaceQuery();
  SurfaceQuery(SurfaceQuery&&) noexcept;
  SurfaceQuery& operator=(SurfaceQuery&&) noexcept;

  /// Distance along the ray, metres, to the first surface that covers at least `coverage` of the
  /// cone. Surfels in the cone are taken front to back and joined to surfaces by their depth
  /// ranges, as the splatter joins them to layers; opacity counts. The distance is the surface's
  /// coverage-weighted mean, taken in dioptres.
  ///   Coverage: the surfel's kernel, convolved with the cone's disc, at the cone's middle, summed
  ///   over the surface. Since the kernels of a closed surface sum to one within 0.1 only, 0.9
  ///   counts as full: a `coverage` above 0.9 asks for 0.9. Depth range: two standard deviations
  ///   along the ray to either side, at least one sigma (the longer axis): ranges that overlap are
  ///   one surface. What reaches nearer to the origin than 1 mm is not seen: the eye sits there.
  /// @param direction       unit length
  /// @param half_angle_rad  > 0, below pi/4
  /// @param coverage        0 < coverage <= 1
  /// @return nothing where no surface covers that much of the cone (a miss)
  std::optional<double> distance(const glm::dvec3& origin_m, const glm::dvec3& direction,
                                 double half_angle_rad, double coverage) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace foci
