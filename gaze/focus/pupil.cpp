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

double fieldArea_deg2(const Screen& screen) {
  const glm::dvec2 half = 0.5 * screen.size_m;
  const double d = screen.distance_m;
  assert(half.x > 0.0 && half.y > 0.0 && d > 0.0);
  const double steradians = 4.0 * std::atan(half.x * half.y / (d * std::hypot(half.x, half.y, d)));
  return steradians * glm::degrees(1.0) * glm::degrees(1.0);
}

double PupilReflex::follow(double time_s, double target_mm) {
  // Time constants, chosen by eye so that constriction is faster (Ellis 1981).
  constexpr double kConstrict_s = 0.4, kDilate_s = 1.2;
  if (!diameter_mm_) {
    diameter_mm_ = target_mm;
  } else {
    assert(time_s >= time_s_);
    const double constant_s = target_mm < *diameter_mm_ ? kConstrict_s : kDilate_s;
    diameter_mm_ =
        target_mm + (*diameter_mm_ - target_mm) * std::exp(-(time_s - time_s_) / constant_s);
  }
  time_s_ = time_s;
  return *diameter_mm_;
}

}  // namespace foci
