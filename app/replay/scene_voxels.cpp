#include <algorithm>
#include <cmath>
#include <limits>

#include "app/replay/scene_view.h"
#include "base/quantile.h"

namespace foci {
namespace {

constexpr double kCubes = 80.0;        // along the longest side
constexpr float kLeastOpacity = 0.3f;  // of what hides something

}  // namespace

float coveringRadius_m(const SurfelCloud& cloud, std::size_t i) {
  return std::sqrt(cloud.area_m2[i] / 2.0f);  // half its square's diagonal
}

float coveringRadius_m(const GaussianCloud& cloud, std::size_t i) {
  return std::sqrt(traceOf(cloud.covariance_m2[i]) / 2.0f);  // flat: its sigma
}

SceneVoxels::SceneVoxels(const Scene& scene, const glm::dvec3& low_m, const glm::dvec3& high_m)
    : low_m_(low_m) {
  std::visit([&](const auto& cloud) { fill(cloud, high_m); }, scene.splats);
}

void SceneVoxels::fill(const auto& cloud, const glm::dvec3& high_m) {
  std::vector<float> radii_m(cloud.size());
  for (std::size_t i = 0; i < radii_m.size(); ++i) radii_m[i] = coveringRadius_m(cloud, i);
  const glm::dvec3 size_m = high_m - low_m_;
  const double longest_m = std::max({size_m.x, size_m.y, size_m.z});
  cube_m_ = std::max({longest_m / kCubes, 2.0 * double{quantile(radii_m, 0.5)}, 1e-9});
  count_ = glm::max(glm::ivec3(glm::ceil(size_m / cube_m_)), 1);
  full_.assign(std::size_t(count_.x) * std::size_t(count_.y) * std::size_t(count_.z), 0);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const glm::dvec3 p(cloud.position_m[i]);
    if (opacityOf(cloud, i) < kLeastOpacity) continue;
    if (!glm::all(glm::lessThanEqual(low_m_, p)) || !glm::all(glm::lessThanEqual(p, high_m))) {
      continue;
    }
    const glm::ivec3 at = glm::min(glm::ivec3((p - low_m_) / cube_m_), count_ - 1);
    full_[indexOf(at)] = 1;
  }
}

std::optional<double> SceneVoxels::distance_m(const glm::dvec3& origin_m,
                                              const glm::dvec3& direction) const {
  const glm::dvec3 origin = (origin_m - low_m_) / cube_m_;  // in cubes
  double enter = 0.0, leave = std::numeric_limits<double>::infinity();
  glm::dvec3 per_cube(std::numeric_limits<double>::infinity());
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(direction[axis]) < 1e-12) {
      if (origin[axis] < 0.0 || origin[axis] >= count_[axis]) return {};
      continue;
    }
    per_cube[axis] = 1.0 / std::abs(direction[axis]);
    const double a = -origin[axis] / direction[axis];
    const double b = (count_[axis] - origin[axis]) / direction[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  if (!(enter < leave)) return {};
  const glm::dvec3 start = origin + enter * direction;
  glm::ivec3 at = glm::clamp(glm::ivec3(glm::floor(start)), glm::ivec3(0), count_ - 1);
  glm::dvec3 next;  // distance to the next face across each axis
  glm::ivec3 step;
  for (int axis = 0; axis < 3; ++axis) {
    step[axis] = direction[axis] > 0.0 ? 1 : -1;
    const double face =
        direction[axis] > 0.0 ? at[axis] + 1.0 - origin[axis] : origin[axis] - at[axis];
    next[axis] = std::isinf(per_cube[axis]) ? per_cube[axis] : face * per_cube[axis];
  }
  for (double from = enter;;) {
    const int axis = next.x < next.y ? (next.x < next.z ? 0 : 2) : (next.y < next.z ? 1 : 2);
    if (full_[indexOf(at)]) {
      return from == 0.0 ? 0.0 : cube_m_ * 0.5 * (from + next[axis]);
    }
    from = next[axis];
    at[axis] += step[axis];
    if (at[axis] < 0 || at[axis] >= count_[axis]) return {};
    next[axis] += per_cube[axis];
  }
}

}  // namespace foci
