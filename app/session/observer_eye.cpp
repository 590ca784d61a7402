#include "app/session/observer_eye.h"

#include <algorithm>
#include <cmath>

namespace foci {
namespace {

constexpr double kDiffraction_m = 555e-9, kSphericalPupil_m = 5e-3;

}  // namespace

Defocus defocusOfEye(const ObserverSettings& observer, double pupil_mm, const glm::vec2& focal_px,
                     double focus_D) {
  Defocus defocus = defocusOfLens(pupil_mm / 1000.0, focal_px, focus_D, DistanceAlong::sight);
  defocus.astigmatism_D = observer.refraction.astigmatism_D;
  return defocus;
}

Pupil pupilOfEye(const ObserverSettings& observer, bool left, double pupil_mm,
                 const glm::vec2& focal_px, double focus_D) {
  // The nose is to the left of the right eye, in the image that it sees.
  const glm::dvec2 from_nasal(left ? 1.0 : -1.0, -1.0);
  Pupil pupil{.diameter_m = pupil_mm / 1000.0};
  if (pupil_mm <= 0.0) return pupil;  // a pinhole
  if (observer.stiles_crawford) {
    pupil.stiles_crawford_per_mm2 = kStilesCrawford_per_mm2;
    pupil.stiles_crawford_center_m = from_nasal * observer.stiles_crawford_center_m;
  }
  pupil.offset_m = from_nasal * observer.pupil_offset_m;
  if (observer.diffraction) {
    pupil.diffraction_px =
        static_cast<float>(diffractionGaussian_rad(pupil.diameter_m, kDiffraction_m) *
                           std::sqrt(focal_px.x * focal_px.y));
  }
  Wavefront measured = observer.wavefronts[left ? 0 : 1];
  const double accommodation_D = std::max(focus_D - observer.refraction.far_point_D, 0.0);
  if (observer.spherical_um_per_D != 0.0 && accommodation_D > 0.0) {
    Wavefront change{.zernike_um = std::vector<double>(13), .pupil_m = kSphericalPupil_m};
    change.zernike_um[12] = observer.spherical_um_per_D * accommodation_D;
    if (measured.pupil_m <= 0.0) measured.pupil_m = kSphericalPupil_m;
    change = rescaled(change, measured.pupil_m);
    measured.zernike_um.resize(std::max<std::size_t>(measured.zernike_um.size(), 13));
    for (std::size_t j = 0; j < 13; ++j) measured.zernike_um[j] += change.zernike_um[j];
  }
  if (!measured) return pupil;
  // The second order, in dioptres, holds at every pupil.
  pupil.wavefront =
      withPower(rescaled(measured, pupil.diameter_m), power_D(observer.wavefronts[left ? 0 : 1]));
  return pupil;
}

}  // namespace foci
