#include "gaze/focus/pupil.h"

#include <cassert>
#include <cmath>

namespace foci {

double pupilDiameter_mm(const PupilScene& scene) {
  assert(scene.luminance_cd_m2 >= 0.0 && scene.area_deg2 > 0.0);
  constexpr double kReferenceAge_years = 28.58;
  const double effect = scene.both_eyes ? 1.0 : 0.1;
  const double flux = std::pow(scene.luminance_cd_m2 * scene.area_deg2 * effect / 846.0, 0.41);
  const double stanley_davies_mm = 7.75 - 5.75 * flux / (flux + 2.0);
  return stanley_davies_mm +
         (scene.age_years - kReferenceAge_years) * (0.021323 - 0.0095623 * stanley_davies_mm);
}

}  // namespace foci
