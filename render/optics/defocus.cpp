#include "render/optics/defocus.h"

#include <cassert>

namespace foci {

Defocus defocusOfLens(double aperture_m, const glm::vec2& focal_px, double focus_D,
                      DistanceAlong along) {
  assert(aperture_m >= 0.0);
  return {.radius_px_per_D = static_cast<float>(aperture_m / 2.0) * focal_px,
          .focus_D = static_cast<float>(focus_D),
          .along = along};
}

glm::vec2 nearestMeridian(const Defocus& defocus) {
  // F's eigenvector: half the angle of (J0, J45).
  const double angle_rad =
      0.5 * std::atan2(double{defocus.astigmatism_D.y}, double{defocus.astigmatism_D.x});
  return {std::cos(angle_rad), std::sin(angle_rad)};
}

double retinalRadius_m(double aperture_m, double retina_m, double point_D, double focus_D) {
  return aperture_m / 2.0 * retina_m * std::abs(point_D - focus_D);
}

double blurAngle_rad(double aperture_m, double point_D, double focus_D) {
  return aperture_m * std::abs(point_D - focus_D);
}

}  // namespace foci
