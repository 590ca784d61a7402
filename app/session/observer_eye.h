// The optics of the observer's own eye.
#pragma once

#include <glm/glm.hpp>

#include "app/session/session_settings.h"
#include "render/optics/defocus.h"
#include "render/optics/pupil.h"

namespace foci {

/// The observer's lens at a focus.
/// @param focal_px  of the view, px for a tangent of 1
/// @param focus_D   mean over all meridians
Defocus defocusOfEye(const ObserverSettings& observer, double pupil_mm, const glm::vec2& focal_px,
                     double focus_D);

/// The pupil of the left or the right eye. The wavefront is rescaled to the pupil in use, and its
/// focus is left out: the eye focuses where the wavefront's root mean square is least. With
/// accommodation, coefficient 12 at a pupil of 5 mm changes by `spherical_um_per_D` (Cheng,
/// Barnett, Vilupuru, Marsack, Kasthurirangan, Applegate and Roorda, Journal of Vision 4, 2004).
/// @param focus_D  mean over all meridians; what exceeds the far point is accommodation
Pupil pupilOfEye(const ObserverSettings& observer, bool left, double pupil_mm,
                 const glm::vec2& focal_px, double focus_D);

}  // namespace foci
