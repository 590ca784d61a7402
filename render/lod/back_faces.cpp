#include "render/lod/back_faces.h"

#include <algorithm>
#include <cmath>

namespace foci {

float lensRadius_m(const View& view, const Defocus& defocus) {
  const glm::vec2 radius_m = defocus.radius_px_per_D / view.focal_px;
  return std::max(radius_m.x, radius_m.y);
}

std::vector<std::uint8_t> bodiesFromOutside(const ClosedBodies& bodies, const View& view,
                                            const Defocus& defocus) {
  std::vector<std::uint8_t> outside(bodies.boxes.size(), 0);
  const glm::vec3 eye_m =
      -glm::transpose(glm::mat3(view.eye_from_world)) * glm::vec3(view.eye_from_world[3]);
  // The near plane's corners lie farther than the plane itself.
  const glm::vec2 corner =
      glm::max(view.principal_px, glm::vec2(view.size_px) - view.principal_px) / view.focal_px;
  const float near_m = view.near_m * std::sqrt(1.0f + glm::dot(corner, corner));
  const float clear_m = near_m + lensRadius_m(view, defocus);
  for (std::size_t i = 1; i < outside.size(); ++i) {
    const ClosedBodies::Box& box = bodies.boxes[i];
    const glm::vec3 away =
        glm::max(glm::max(box.low_m - eye_m, eye_m - box.high_m), glm::vec3(0.0f));
    outside[i] = glm::length(away) > clear_m ? 1 : 0;
  }
  return outside;
}

FacingSide sideOf(const Facing& facing, const glm::vec3& normal, const glm::vec3& p, float radius_m,
                  float lens_m) {
  if (facing.cos_cone == 0) return FacingSide::both;
  const float cos_cone = static_cast<float>(facing.cos_cone) * (1.0f / 65535.0f);
  const float sin_cone = std::sqrt(std::max(1.0f - cos_cone * cos_cone, 0.0f));
  // Along the mean normal and across it: distances by which the node lies behind its own planes.
  const float along = glm::dot(normal, p);
  const float across = std::sqrt(std::max(glm::dot(p, p) - along * along, 0.0f));
  const float reach = radius_m + lens_m;
  if (along * cos_cone - across * sin_cone > reach) return FacingSide::backs;
  if (along * cos_cone + across * sin_cone < -reach) return FacingSide::fronts;
  return FacingSide::both;
}

}  // namespace foci
