#include "render/scene/surfel_cloud.h"

#include "render/scene/gaussian_cloud.h"

namespace foci {

std::span<const glm::vec3> positionsOf(const SurfelCloud& cloud) {
  if (cloud.gaussians) return cloud.gaussians->position_m;
  return cloud.position_m;
}

void appendSurfel(SurfelCloud& cloud, const glm::vec3& position_m, const glm::vec3& normal,
                  float sigma_m, float area_m2, const glm::vec3& color, float opacity) {
  const glm::vec3 u = tangentTo(normal), v = glm::cross(normal, u);

  // Opacities are stored from the first surfel that is not opaque.
  if (opacity != 1.0f || !cloud.opacity.empty()) {
    cloud.opacity.resize(cloud.size(), 1.0f);
    cloud.opacity.push_back(opacity);
  }
  cloud.position_m.push_back(position_m);
  cloud.axis_u_m.push_back(sigma_m * u);
  cloud.axis_v_m.push_back(sigma_m * v);
  cloud.color.push_back(color);
  cloud.area_m2.push_back(area_m2);
}

}  // namespace foci
