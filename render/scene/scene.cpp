#include "render/scene/scene.h"

#include "render/scene/gaussian_merge.h"

namespace foci {

std::span<const glm::vec3> Scene::position_m() const {
  const auto places = [](const auto& cloud) -> std::span<const glm::vec3> {
    return cloud.position_m;
  };
  return std::visit(places, splats);
}

glm::vec3 displayColorOf(const SurfelCloud& cloud, std::size_t i) {
  const glm::vec3 light = glm::clamp(cloud.color[i], 0.0f, 1.0f);
  return {displayOfLinear(light.x), displayOfLinear(light.y), displayOfLinear(light.z)};
}

glm::vec3 displayColorOf(const GaussianCloud& cloud, std::size_t i) {
  return glm::clamp(cloud.color[i], 0.0f, 1.0f);
}

}  // namespace foci
