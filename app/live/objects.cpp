#include "app/live/objects.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <string>
#include <utility>

namespace foci {
namespace {

constexpr double kHalfWidth_deg = 2.0;
constexpr int kSides = 32;  // of a circle

}  // namespace

NamedShape objectAt(const glm::dvec3& point_m, double distance_m,
                    const std::vector<NamedShape>& others) {
  std::string name;
  for (std::size_t i = 1; name.empty(); ++i) {
    std::string next = "object " + std::to_string(i);
    if (std::ranges::find(others, next, &NamedShape::name) == others.end()) name = std::move(next);
  }
  return {.name = std::move(name),
          .center_m = point_m,
          .radius_m = distance_m * std::tan(glm::radians(kHalfWidth_deg))};
}

void changeKind(NamedShape& shape) {
  if (shape.radius_m) {
    shape.size_m = glm::dvec3(2.0 * *std::exchange(shape.radius_m, std::nullopt));
  } else {
    const glm::dvec3 size_m = *std::exchange(shape.size_m, std::nullopt);
    shape.radius_m = 0.5 * std::max({size_m.x, size_m.y, size_m.z});
  }
}

std::vector<glm::vec3> linesOf(const NamedShape& shape) {
  std::vector<glm::vec3> ends_m;
  const auto add = [&](const glm::dvec3& from, const glm::dvec3& to) {
    ends_m.emplace_back(shape.center_m + from);
    ends_m.emplace_back(shape.center_m + to);
  };
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 u(0.0), v(0.0), w(0.0);
    u[axis] = v[(axis + 1) % 3] = w[(axis + 2) % 3] = 1.0;
    if (shape.size_m) {
      for (const auto& [a, b] : {std::pair{-1.0, -1.0}, {-1.0, 1.0}, {1.0, -1.0}, {1.0, 1.0}}) {
        const glm::dvec3 edge = 0.5 * (a * v + b * w);
        add((edge - 0.5 * u) * *shape.size_m, (edge + 0.5 * u) * *shape.size_m);
      }
    } else {
      const auto at = [&](int side) {
        const double angle_rad = glm::two_pi<double>() * side / kSides;
        return *shape.radius_m * (std::cos(angle_rad) * v + std::sin(angle_rad) * w);
      };
      for (int side = 0; side < kSides; ++side) add(at(side), at(side + 1));
    }
  }
  return ends_m;
}

}  // namespace foci
