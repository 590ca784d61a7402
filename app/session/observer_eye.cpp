#include "app/session/observer_eye.h"

#include "render/methods/method.h"

namespace foci {

Refraction refractionInForce(const Study& study) {
  const Study::Observer& observer = study.observer;
  if (observer.corrected) return {};
  return refractionOf({.sphere_D = observer.sphere_D,
                       .cylinder_D = observer.cylinder_D,
                       .axis_deg = observer.axis_deg});
}

AccommodationSettings accommodationOf(const Study& study) {
  AccommodationSettings settings = study.focus.accommodation;
  settings.far_point_D = refractionInForce(study).far_point_D;
  return settings;
}

Defocus defocusOfEye(const Study& study, double pupil_mm, const glm::vec2& focal_px,
                     double focus_D) {
  Defocus defocus = defocusOfLens(pupil_mm / 1000.0, focal_px, focus_D, DistanceAlong::sight);
  defocus.astigmatism_D = refractionInForce(study).astigmatism_D;
  if (study.observer.chromatic) defocus.chromatic_D = chromaticDifferenceOfPrimaries_D();
  return defocus;
}

std::string ellipseText(const Study& study) {
  const std::string& method = study.render.method;
  if (refractionInForce(study).astigmatism_D == glm::vec2(0.0f) || rendersEllipses(method))
    return {};
  return "method " + method +
         " has one radius of blur: an astigmatic eye's ellipses are circles of the same variance.";
}

}  // namespace foci
