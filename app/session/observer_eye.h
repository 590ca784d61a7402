// The observer's own eye, as the study describes it: how far it can focus, and what its lens does.
#pragma once

#include <glm/glm.hpp>
#include <string>

#include "app/study/study.h"
#include "gaze/focus/accommodation.h"
#include "render/optics/defocus.h"
#include "render/optics/refraction.h"

namespace foci {

/// What the prescription leaves: nothing where it is worn.
Refraction refractionInForce(const Study& study);

/// The study's, from the far point of the eye on.
AccommodationSettings accommodationOf(const Study& study);

/// The observer's lens.
/// @param focus_D  mean of all meridians
Defocus defocusOfEye(const Study& study, double pupil_mm, const glm::vec2& focal_px,
                     double focus_D);

/// Where a method renders the ellipses of an astigmatic eye as circles, a sentence that says so;
/// else nothing.
std::string ellipseText(const Study& study);

}  // namespace foci
