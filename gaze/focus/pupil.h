// Pupil diameter from luminance (Watson and Yellott 2012, "A unified formula for light-adapted
// pupil size").
#pragma once

#include <optional>

#include "gaze/geometry/gaze_sample.h"

namespace foci {

struct PupilScene {
  double luminance_cd_m2 = 0.0;  ///< mean of the field, >= 0
  double area_deg2 = 0.0;        ///< of the field, > 0
  bool both_eyes = true;         ///< false: the other eye is covered, a tenth of the effect
  double age_years = 30.0;       ///< the formula holds for adults of 20 to 83 years
};

/// Pupil diameter, millimetres, with luminance L, area a and effect e (1, or 0.1 with one eye):
///   F = (L a e / 846)^0.41,   D_SD = 7.75 - 5.75 F / (F + 2),
///   D = D_SD + (age - 28.58) (0.021323 - 0.0095623 D_SD)
double pupilDiameter_mm(const PupilScene& scene);

/// Solid angle of the screen as the eye in front of its centre sees it, square degrees:
///   Omega = 4 atan(a b / (d sqrt(a^2 + b^2 + d^2))),   a, b half the width and height.
/// @param screen  with known size and distance
double fieldArea_deg2(const Screen& screen);

/// The pupil approaches the diameter of `pupilDiameter_mm` exponentially. It constricts faster than
/// it dilates, like the light reflex (Ellis 1981). It starts at the first target.
class PupilReflex {
 public:
  /// @param target_mm  diameter that the pupil approached since the last call
  /// @param time_s     never decreases
  /// @return diameter at `time_s`
  double follow(double time_s, double target_mm);

 private:
  std::optional<double> diameter_mm_{};
  double time_s_ = 0.0;
};

}  // namespace foci
