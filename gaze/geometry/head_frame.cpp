#include "gaze/geometry/head_frame.h"

#include <algorithm>

#include "gaze/geometry/line_of_sight.h"

namespace foci {

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
    const auto half = along.begin() + static_cast<std::ptrdiff_t>(along.size() / 2);
    std::nth_element(along.begin(), half, along.end());
    middle_m[axis] = *half;
  }
  return middle_m;
}

}  // namespace foci
