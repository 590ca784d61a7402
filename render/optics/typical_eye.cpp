#include "render/optics/typical_eye.h"

#include <cmath>

namespace foci {

Wavefront typicalWavefront(double age_years) {
  constexpr double kComa_um = 0.14, kTrefoil_um = 0.11, kSpherical_um = 0.13, kAll_um = 0.33;
  constexpr double kPerYear_um = 0.0032, kPupil_m = 6e-3, kAgeingPupil_m = 5e-3;
  const double scale = kAll_um / std::sqrt(kComa_um * kComa_um + kTrefoil_um * kTrefoil_um +
                                           kSpherical_um * kSpherical_um);
  Wavefront w{.zernike_um = std::vector<double>(13), .pupil_m = kPupil_m};
  w.zernike_um[6] = -scale * kTrefoil_um;
  w.zernike_um[7] = scale * kComa_um;
  w.zernike_um[12] = scale * kSpherical_um;
  const double at_ageing_um = rms_um(rescaled(w, kAgeingPupil_m), 3);
  const double aged = 1.0 + kPerYear_um * (age_years - kTypicalAge_years) / at_ageing_um;
  for (double& um : w.zernike_um) um *= aged;
  return w;
}

}  // namespace foci
