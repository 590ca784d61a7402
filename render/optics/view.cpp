#include "render/optics/view.h"

#include <cassert>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

namespace foci {

glm::mat4 eyeFromWorld(const glm::vec3& position_m, const glm::vec3& target_m,
                       const glm::vec3& up) {
  assert(glm::length(glm::cross(target_m - position_m, up)) > 0.0f);
  return glm::lookAt(position_m, target_m, up);
}

View viewThroughScreen(const glm::mat4& eye_from_world, const glm::ivec2& size_px,
                       const glm::dvec2& screen_size_m, double distance_m,
                       const glm::dvec2& faced_m) {
  const glm::dvec2 faced = glm::dvec2(faced_m.x, -faced_m.y) / screen_size_m;
  return {.eye_from_world = eye_from_world,
          .size_px = size_px,
          .focal_px = glm::vec2(distance_m * glm::dvec2(size_px) / screen_size_m),
          .principal_px = glm::vec2((faced + 0.5) * glm::dvec2(size_px))};
}

View viewOfCamera(const glm::mat4& eye_from_world, const glm::ivec2& size_px, double fov_y_rad) {
  const double focal_px = 0.5 * size_px.y / std::tan(0.5 * fov_y_rad);
  return {.eye_from_world = eye_from_world,
          .size_px = size_px,
          .focal_px = glm::vec2(static_cast<float>(focal_px)),
          .principal_px = 0.5f * glm::vec2(size_px)};
}

glm::dvec3 directionThrough(const View& view, const glm::dvec2& point_px) {
  const glm::dvec2 tangent = (point_px - glm::dvec2(view.principal_px)) / glm::dvec2(view.focal_px);
  return glm::normalize(glm::dvec3(tangent.x, -tangent.y, -1.0));
}

}  // namespace foci
