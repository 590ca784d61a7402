// A scene: surfels, or the Gaussians of a capture.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <span>
#include <variant>

#include "render/scene/gaussian_cloud.h"
#include "render/scene/surfel_cloud.h"

namespace foci {

/// What both kinds have (members of one name, `largestSigma`, `withTree`) is reached by
/// `std::visit`, without asking which kind it is.
struct Scene {
  std::variant<SurfelCloud, GaussianCloud> splats;

  /// Null for a scene of Gaussians.
  const SurfelCloud* surfels() const { return std::get_if<SurfelCloud>(&splats); }
  /// Null for a scene of surfels.
  const GaussianCloud* gaussians() const { return std::get_if<GaussianCloud>(&splats); }

  std::span<const glm::vec3> position_m() const;
};

/// As a display shows it (sRGB), 0 to 1; of a Gaussian, without its harmonics.
glm::vec3 displayColorOf(const SurfelCloud& cloud, std::size_t i);
glm::vec3 displayColorOf(const GaussianCloud& cloud, std::size_t i);

}  // namespace foci
