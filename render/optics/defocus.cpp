#include "render/optics/defocus.h"

#include <cassert>
#include <limits>

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

double imageDistance_m(double focal_length_m, double object_m) {
  const double vergence_D = 1.0 / focal_length_m - 1.0 / object_m;
  return vergence_D == 0.0 ? std::numeric_limits<double>::infinity() : 1.0 / vergence_D;
}

double circleOfConfusion_m(double aperture_m, double focal_length_m, double point_m,
                           double focus_m) {
  const double v_point_m = imageDistance_m(focal_length_m, point_m);
  const double v_focus_m = imageDistance_m(focal_length_m, focus_m);
  return aperture_m / 2.0 * std::abs(v_point_m - v_focus_m) / v_point_m;
}

double retinalRadius_m(double aperture_m, double retina_m, double point_D, double focus_D) {
  return aperture_m / 2.0 * retina_m * std::abs(point_D - focus_D);
}

double blurAngle_rad(double aperture_m, double point_D, double focus_D) {
  return aperture_m * std::abs(point_D - focus_D);
}

}  // namespace foci
