#include "render/scene/gaussian_cloud.h"

#include "base/parallel.h"
#include "render/scene/gaussian_tree.h"

namespace foci {

Covariance3 covarianceOf(const glm::vec3& sigma, const glm::vec4& rotation) {
  const float x = rotation.x, y = rotation.y, z = rotation.z, w = rotation.w;
  // Columns: where the rotation takes the axes.
  const glm::vec3 a = sigma.x * glm::vec3(1.0f - 2.0f * (y * y + z * z), 2.0f * (x * y + w * z),
                                          2.0f * (x * z - w * y));
  const glm::vec3 b = sigma.y * glm::vec3(2.0f * (x * y - w * z), 1.0f - 2.0f * (x * x + z * z),
                                          2.0f * (y * z + w * x));
  const glm::vec3 c = sigma.z * glm::vec3(2.0f * (x * z + w * y), 2.0f * (y * z - w * x),
                                          1.0f - 2.0f * (x * x + y * y));
  return {.xx = a.x * a.x + b.x * b.x + c.x * c.x,
          .xy = a.x * a.y + b.x * b.y + c.x * c.y,
          .xz = a.x * a.z + b.x * b.z + c.x * c.z,
          .yy = a.y * a.y + b.y * b.y + c.y * c.y,
          .yz = a.y * a.z + b.y * b.z + c.y * c.z,
          .zz = a.z * a.z + b.z * b.z + c.z * c.z};
}

void scaleBy(GaussianCloud& cloud, float factor) {
  if (factor == 1.0f) return;
  const float squared = factor * factor;
  parallelFor(cloud.size(), [&](std::size_t i) {
    cloud.position_m[i] *= factor;
    Covariance3& v = cloud.covariance_m2[i];
    for (float* each : {&v.xx, &v.xy, &v.xz, &v.yy, &v.yz, &v.zz}) *each *= squared;
  });
  if (!cloud.tree) return;
  const auto tree = std::make_shared<GaussianTree>(*cloud.tree);
  scaleBy(tree->nodes, factor);
  parallelFor(tree->radius_m.size(), [&](std::size_t node) {
    tree->radius_m[node] *= factor;
    tree->spread_m2[node] *= squared;
    tree->growth_per_m2[node] /= squared;
  });
  cloud.tree = tree;
}

}  // namespace foci
