// The optics of the observer's own eye.
#pragma once

#include <glm/glm.hpp>

#include "app/session/session_settings.h"
#include "render/optics/defocus.h"

namespace foci {

/// The observer's lens at a focus.
/// @param focal_px  of the view, px for a tangent of 1
/// @param focus_D   mean over all meridians
Defocus defocusOfEye(const ObserverSettings& observer, double pupil_mm, const glm::vec2& focal_px,
                     double focus_D);

}  // namespace foci
