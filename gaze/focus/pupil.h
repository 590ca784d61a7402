// The pupil from the light (Watson and Yellott 2012, "A unified formula for light-adapted pupil
// size").
#pragma once

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

}  // namespace foci
