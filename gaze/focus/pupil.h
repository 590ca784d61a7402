// The pupil from the light (Watson and Yellott 2012, "A unified formula for light-adapted pupil
// size").
#pragma once

#include <optional>

#include "gaze/geometry/gaze_sample.h"

namespace foci {

struct PupilScene {
  double luminance_cd_m2 = 0.0;  ///< mean of the field, >= 0
  double area_deg2 = 0.0;        ///< of the field, > 0
  bool both_eyes = true;         ///< one eye alone gets a tenth of the effect
  double age_years = 30.0;       ///< the formula is of adults, 20 to 83
};

/// Diameter, millimetres.
///   F = (L a e / 846)^0.41,   D_SD = 7.75 - 5.75 F / (F + 2),
///   D = D_SD + (age - 28.58) (0.021323 - 0.0095623 D_SD)
double pupilDiameter_mm(const PupilScene& scene);

/// Solid angle of the whole screen at the eye before its centre, square degrees:
///   Omega = 4 atan(a b / (d sqrt(a^2 + b^2 + d^2))),   a, b half its width and height.
/// @param screen  with its size and distance known
double fieldArea_deg2(const Screen& screen);

/// The pupil on its way to the diameter that the light asks for: an exponential approach, quicker
/// to narrow than to widen, as the light reflex is (Ellis 1981). The first diameter is taken at
/// once.
class PupilReflex {
 public:
  /// @param target_mm  asked for since the last call
  /// @param time_s     not before the last
  double follow(double time_s, double target_mm);

 private:
  std::optional<double> diameter_mm_{};
  double time_s_ = 0.0;
};

}  // namespace foci
