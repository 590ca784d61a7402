#include "gaze/geometry/line_of_sight.h"

#include <cassert>
#include <cmath>
#include <vector>

#include "base/quantile.h"

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

std::optional<glm::dvec2> Cyclopean::combine(double time_s,
                                             const std::optional<glm::dvec2>& left_px,
                                             const std::optional<glm::dvec2>& right_px) {
  constexpr double kMemory_s = 0.3;  // chosen by eye: vergence hardly changes within a fixation
  if (left_px && right_px) {
    const glm::dvec2 half = 0.5 * (*right_px - *left_px);
    const double keep = half_px_ ? std::exp(-(time_s - time_s_) / kMemory_s) : 0.0;
    half_px_ = half_px_ ? glm::mix(half, *half_px_, keep) : half;
    time_s_ = time_s;
    return 0.5 * (*left_px + *right_px);
  }
  const glm::dvec2 half = half_px_.value_or(glm::dvec2(0.0));
  if (left_px) return *left_px + half;
  if (right_px) return *right_px - half;
  return std::nullopt;
}

std::optional<glm::dvec3> sightInWorld(const GazeSample& sample, const Screen& screen) {
  if (!sample.point_px) return std::nullopt;
  const glm::dvec3 sight = lineOfSight(screen, *sample.point_px);
  return sample.head ? sample.head->world_from_head * sight : sight;
}

std::optional<glm::dvec2> pointSeenBy_px(const GazeSample& now, const GazeSample& sample,
                                         const Screen& screen) {
  if (!sample.head || !now.head) return sample.point_px;
  const auto sight = sightInWorld(sample, screen);
  if (!sight) return std::nullopt;
  return pointOnScreen_px(screen, glm::conjugate(now.head->world_from_head) * *sight);
}

glm::dvec3 middleOfEyes_m(const std::vector<GazeSample>& samples) {
  glm::dvec3 middle_m(0.0);
  std::vector<double> along;
  for (int axis = 0; axis < 3; ++axis) {
    along.clear();
    for (const GazeSample& sample : samples) {
      const auto &left = sample.eyes[0].origin_m, &right = sample.eyes[1].origin_m;
      if (sample.head && left && right) along.push_back(0.5 * ((*left)[axis] + (*right)[axis]));
    }
    if (along.empty()) return glm::dvec3(0.0);
    middle_m[axis] = quantile(along, 0.5);
  }
  return middle_m;
}

}  // namespace foci
