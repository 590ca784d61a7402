// What readers of scans share: coordinates far from the origin, and intensity. Private to the
// readers.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "render/scene/point_cloud.h"

namespace foci {

/// Light of a point without a colour: sRGB 0.5.
inline constexpr float kUncolouredLight = 0.2140f;

/// Appends points whose coordinates may be as large as those of a map projection. A float at 10,000
/// has steps of 1 mm. So the first point decides an origin, in whole thousands on each axis where
/// it is 10,000 or farther out, and positions are relative to this origin.
class ScanPositions {
 public:
  explicit ScanPositions(PointCloud& points) : points_(points) {}

  /// @return false, with the point counted as dropped, if it is not finite or too far away
  bool append(const glm::dvec3& p);

  /// Adds a remark to the points if the origin was moved.
  void finish() const;

 private:
  PointCloud& points_;
  std::optional<glm::dvec3> origin_;
};

/// Shows intensities as grey. The 1 % quantile becomes black and the 99 % quantile white, in sRGB
/// code values. Equal intensities become the colour of points without one.
std::vector<glm::vec3> greyOf(const std::vector<float>& intensity);

}  // namespace foci
