#include "gaze/geometry/line_of_sight.h"

#include <cassert>
#include <cmath>

namespace foci {
namespace {

glm::dvec2 pointAtOffset_px(const Screen& screen, const glm::dvec2& offset) {
  const glm::dvec2 from_centre = offset + screen.faced_m;
  return (glm::dvec2(from_centre.x, -from_centre.y) / screen.size_m + 0.5) *
         glm::dvec2(screen.size_px);
}

}  // namespace

glm::dvec2 offsetOnScreen_m(const Screen& screen, const glm::dvec2& point_px) {
  assert(screen.size_px.x > 0 && screen.size_px.y > 0 && screen.size_m.x > 0.0 &&
         screen.size_m.y > 0.0 && screen.distance_m > 0.0);
  const glm::dvec2 offset = (point_px / glm::dvec2(screen.size_px) - 0.5) * screen.size_m;
  return glm::dvec2(offset.x, -offset.y) - screen.faced_m;
}

glm::dvec3 lineOfSight(const Screen& screen, const glm::dvec2& point_px) {
  return glm::normalize(glm::dvec3(offsetOnScreen_m(screen, point_px), -screen.distance_m));
}

std::optional<glm::dvec2> pointOnScreen_px(const Screen& screen, const glm::dvec3& direction) {
  if (!(direction.z < 0.0)) return std::nullopt;
  return pointAtOffset_px(screen, glm::dvec2(direction) * (screen.distance_m / -direction.z));
}

double angleBetween_deg(const Screen& screen, const glm::dvec2& a_px, const glm::dvec2& b_px) {
  const glm::dvec3 a(offsetOnScreen_m(screen, a_px), -screen.distance_m);
  const glm::dvec3 b(offsetOnScreen_m(screen, b_px), -screen.distance_m);
  return glm::degrees(std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)));
}

glm::dvec2 eccentricity_deg(const Screen& screen, const glm::dvec2& point_px) {
  return glm::degrees(glm::atan(offsetOnScreen_m(screen, point_px) / screen.distance_m));
}

glm::dvec2 pointAtEccentricity_px(const Screen& screen, const glm::dvec2& eccentricity_deg) {
  return pointAtOffset_px(screen, screen.distance_m * glm::tan(glm::radians(eccentricity_deg)));
}

}  // namespace foci
