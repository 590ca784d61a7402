#include "render/literature/raytrace/seen_surfel.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/parallel.h"
#include "render/kernel/limits.h"

namespace foci {
namespace {

SeenSurfel seen(const SurfelCloud& cloud, std::size_t i, const View& view,
                const glm::mat3& rotation, DistanceAlong along, float shading) {
  const glm::vec3 p(view.eye_from_world * glm::vec4(cloud.position_m[i], 1.0f));
  const glm::vec3 u = rotation * cloud.axis_u_m[i], v = rotation * cloud.axis_v_m[i];
  const float depth_m = -p.z;
  const glm::vec2 tangent = glm::vec2(p) / depth_m;
  const glm::vec2 px_per_m = view.focal_px * glm::vec2(1.0f, -1.0f) / depth_m;
  const bool along_axis = along == DistanceAlong::axis;
  const float distance_m = along_axis ? depth_m : glm::length(p);
  const float u_m = along_axis ? -u.z : glm::dot(u, p) / distance_m;
  const float v_m = along_axis ? -v.z : glm::dot(v, p) / distance_m;
  const float vergence_D = 1.0f / distance_m;
  const float uu = glm::dot(u, u), vv = glm::dot(v, v), parallelogram = std::sqrt(uu * vv);
  const float reach_m = std::sqrt(kReach2 * (u_m * u_m + v_m * v_m) + std::max(uu, vv));
  const float away = glm::dot(glm::cross(u, v), p) / (parallelogram * glm::length(p));
  const float opacity = cloud.opacity.empty() ? 1.0f : cloud.opacity[i];
  const float shade = 1.0f + shading * (std::abs(away) - 1.0f);
  return {.center_px = project(view, p),
          .u_px = px_per_m * (glm::vec2(u) + u.z * tangent),
          .v_px = px_per_m * (glm::vec2(v) + v.z * tangent),
          .u_D = u_m * vergence_D * vergence_D,
          .v_D = v_m * vergence_D * vergence_D,
          .vergence_D = vergence_D,
          .area_per_axes = cloud.area_m2[i] / parallelogram,
          .color = shade * opacity * cloud.color[i],
          .opacity = opacity,
          .back_facing = cloud.oriented && away > 0.0f,
          .distance_m = distance_m,
          .near_m = std::max(distance_m - reach_m, 0.0f),
          .far_m = distance_m + reach_m};
}

/// A sum with a term that is not finite is not finite.
bool allFinite(const SeenSurfel& surfel) {
  return std::isfinite(surfel.center_px.x + surfel.center_px.y + surfel.far_m +
                       surfel.area_per_axes + surfel.u_D + surfel.v_D);
}

}  // namespace

std::vector<SeenSurfel> seenSurfels(const SurfelCloud& cloud, const View& view, DistanceAlong along,
                                    float shading) {
  const glm::mat3 rotation(view.eye_from_world);
  std::vector<SeenSurfel> all(cloud.size());
  std::vector<std::uint8_t> kept(cloud.size());
  parallelFor(cloud.size(), [&](std::size_t i) {
    const glm::vec3 p(view.eye_from_world * glm::vec4(cloud.position_m[i], 1.0f));
    if (!(-p.z >= view.near_m)) return;
    all[i] = seen(cloud, i, view, rotation, along, shading);
    kept[i] = allFinite(all[i]);
  });
  std::size_t count = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (kept[i]) all[count++] = all[i];
  }
  all.resize(count);
  std::stable_sort(all.begin(), all.end(), [](const SeenSurfel& a, const SeenSurfel& b) {
    return a.distance_m < b.distance_m;
  });
  return all;
}

}  // namespace foci
