#include "app/session/observer_eye.h"

namespace foci {

Defocus defocusOfEye(const ObserverSettings& observer, double pupil_mm, const glm::vec2& focal_px,
                     double focus_D) {
  Defocus defocus = defocusOfLens(pupil_mm / 1000.0, focal_px, focus_D, DistanceAlong::sight);
  defocus.astigmatism_D = observer.refraction.astigmatism_D;
  if (observer.chromatic) defocus.chromatic_D = chromaticDifferenceOfPrimaries_D();
  return defocus;
}

}  // namespace foci
