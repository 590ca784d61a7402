#include "render/scene/surfel_cloud.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace foci {

float largestSigma(const SurfelCloud& cloud, std::size_t i) {
  return std::max(glm::length(cloud.axis_u_m[i]), glm::length(cloud.axis_v_m[i]));
}

std::pair<glm::vec3, glm::vec3> boxOf(std::span<const glm::vec3> places) {
  glm::vec3 low(places[0]), high(low);
  for (const glm::vec3& p : places) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  return {low, high};
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

void completeBodies(SurfelCloud& cloud) {
  constexpr float kExtent = 3.0f;  // standard deviations
  ClosedBodies& bodies = cloud.bodies;
  if (bodies.of_surfel.empty()) {
    bodies = {};
    return;
  }
  std::vector<std::uint16_t>& of = bodies.of_surfel.own();
  const std::size_t count = 1 + *std::ranges::max_element(of);
  std::vector<std::uint8_t> opaque(count, 1);
  for (std::size_t i = 0; i < of.size() && !cloud.opacity.empty(); ++i) {
    if (cloud.opacity[i] < 1.0f) opaque[of[i]] = 0;
  }
  bodies.boxes.assign(count, {glm::vec3(std::numeric_limits<float>::max()),
                              glm::vec3(std::numeric_limits<float>::lowest())});
  bool any = false;
  for (std::size_t i = 0; i < of.size(); ++i) {
    if (opaque[of[i]] == 0) of[i] = 0;
    any = any || of[i] != 0;
    const glm::vec3 reach =
        kExtent * glm::max(glm::abs(cloud.axis_u_m[i]), glm::abs(cloud.axis_v_m[i]));
    ClosedBodies::Box& box = bodies.boxes[of[i]];
    box.low_m = glm::min(box.low_m, cloud.position_m[i] - reach);
    box.high_m = glm::max(box.high_m, cloud.position_m[i] + reach);
  }
  if (!any) bodies = {};
}

}  // namespace foci
