#include "render/optics/refraction.h"

#include <cmath>

namespace foci {

Refraction refractionOf(const Prescription& prescription) {
  const double half_D = 0.5 * prescription.cylinder_D;
  const double twice_rad = glm::radians(2.0 * prescription.axis_deg);
  return {
      .far_point_D = -(prescription.sphere_D + half_D),
      .astigmatism_D = glm::vec2(half_D * glm::dvec2(std::cos(twice_rad), std::sin(twice_rad)))};
}

double chromaticDifference_D(double wavelength_um) {
  return 0.63346 / (wavelength_um - 0.2141) - 1.7312;
}

glm::vec3 chromaticDifferenceOfPrimaries_D() {
  return {chromaticDifference_D(0.6114), chromaticDifference_D(0.5491),
          chromaticDifference_D(0.4642)};
}

}  // namespace foci
