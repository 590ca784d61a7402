// Moves captured scenes.
#pragma once

#include <glm/glm.hpp>

#include "render/scene/gaussian_cloud.h"

namespace foci {

/// Moves the scene: p becomes linear p + offset. Colours that depend on the direction turn with it
/// (harmonics_rotation.h). The tree is dropped.
/// @param linear  invertible; it may mirror
void transform(GaussianCloud& cloud, const glm::mat3& linear, const glm::vec3& offset);

}  // namespace foci
