#include "calibration/binocular/binocular.h"

#include <algorithm>
#include <cmath>

#include "gaze/focus/vergence.h"

namespace foci {

glm::dvec3 correctedDirection(const BinocularMap& map, std::size_t eye,
                              const glm::dvec3& direction) {
  const glm::dvec3 d = glm::normalize(direction);
  const double yaw = std::atan2(d.x, d.z) + map.kappa_rad[eye].x;
  const double pitch = std::asin(std::clamp(d.y, -1.0, 1.0)) + map.kappa_rad[eye].y;
  return {std::sin(yaw) * std::cos(pitch), std::sin(pitch), std::cos(yaw) * std::cos(pitch)};
}

std::optional<glm::dvec2> pointOnDisplay(const BinocularMap& map, std::size_t eye,
                                         const BinocularSample::Eye& measured) {
  const glm::dmat3 display_from_tracker = glm::transpose(map.rotation);
  const glm::dvec3 from = display_from_tracker * (measured.centre_m - map.translation_m);
  const glm::dvec3 along = display_from_tracker * correctedDirection(map, eye, measured.direction);
  if (along.z == 0.0 || -from.z / along.z <= 0.0) return std::nullopt;
  return glm::dvec2(from - from.z / along.z * along);
}

std::optional<double> vergence_D(const BinocularMap& map, const BinocularSample& sample) {
  if (!sample.eyes[0] || !sample.eyes[1]) return std::nullopt;
  const glm::dvec3 left = correctedDirection(map, 0, sample.eyes[0]->direction);
  const glm::dvec3 right = correctedDirection(map, 1, sample.eyes[1]->direction);
  return vergence_D(EyeRay{.origin_m = sample.eyes[0]->centre_m, .direction = left},
                    EyeRay{.origin_m = sample.eyes[1]->centre_m, .direction = right});
}

std::vector<double> errorsOf_deg(const BinocularMap& map,
                                 std::span<const BinocularSample> samples) {
  std::vector<double> errors;
  for (const BinocularSample& sample : samples) {
    const glm::dvec3 target = map.rotation * glm::dvec3(sample.target_m, 0.0) + map.translation_m;
    for (std::size_t eye = 0; eye < 2; ++eye) {
      if (!sample.eyes[eye]) continue;
      const glm::dvec3 to = target - sample.eyes[eye]->centre_m;
      const glm::dvec3 sight = correctedDirection(map, eye, sample.eyes[eye]->direction);
      errors.push_back(
          glm::degrees(std::atan2(glm::length(glm::cross(to, sight)), glm::dot(to, sight))));
    }
  }
  return errors;
}

}  // namespace foci
