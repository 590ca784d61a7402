#include "render/scene/sampling/poisson_disk.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <random>

namespace foci {
namespace {

constexpr double kDartsAPoint = 12.0;
constexpr double kMost = 3.0;         // times the points wanted; slivers would take all darts
constexpr float kFacingAway = -0.5f;  // cosine of normals
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

glm::dvec3 crossOf(const std::vector<glm::vec3>& corners_m, std::size_t triangle) {
  const glm::dvec3 a = corners_m[3 * triangle], b = corners_m[3 * triangle + 1],
                   c = corners_m[3 * triangle + 2];
  return glm::cross(b - a, c - a);
}

/// Areas summed up to each triangle, itself included.
std::vector<double> summedAreas(const std::vector<glm::vec3>& corners_m) {
  std::vector<double> sums(corners_m.size() / 3);
  double sum = 0.0;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    sums[i] = sum += 0.5 * glm::length(crossOf(corners_m, i));
  }
  return sums;
}

/// The 27 cells around a point: its own, then those across faces, edges and corners. Most darts
/// meet a point in the first few.
constexpr int kNearestFirst[27] = {13, 4,  10, 12, 14, 16, 22, 1, 3, 5,  7,  9,  11, 15,
                                   17, 19, 21, 23, 25, 0,  2,  6, 8, 18, 20, 24, 26};

/// The accepted points by cells as wide as their least distance; cells share hashed lists.
class Grid {
 public:
  Grid(std::size_t expected, double distance_m)
      : distance_m_(distance_m), heads_(std::bit_ceil(2 * expected + 1), kNone) {}

  bool isFree(const glm::dvec3& p, const glm::vec3& normal) const {
    const glm::dvec3 cell = glm::floor(p / distance_m_);
    for (const int k : kNearestFirst) {
      const glm::dvec3 at = cell + glm::dvec3(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
      for (std::uint32_t i = heads_[slotOf(at)]; i != kNone; i = next_[i]) {
        const glm::dvec3 d = position_m_[i] - p;
        if (glm::dot(d, d) < distance_m_ * distance_m_ &&
            glm::dot(normal_[i], normal) > kFacingAway) {
          return false;
        }
      }
    }
    return true;
  }

  void add(const glm::dvec3& p, const glm::vec3& normal) {
    std::uint32_t& head = heads_[slotOf(glm::floor(p / distance_m_))];
    next_.push_back(head);
    head = static_cast<std::uint32_t>(position_m_.size());
    position_m_.push_back(p);
    normal_.push_back(normal);
  }

 private:
  std::size_t slotOf(const glm::dvec3& cell) const {
    std::uint64_t hash = 0;
    for (int axis = 0; axis < 3; ++axis) {
      hash = (hash ^ std::bit_cast<std::uint64_t>(cell[axis] + 0.0)) * 0x9e3779b97f4a7c15;
      hash ^= hash >> 32;
    }
    return hash & (heads_.size() - 1);
  }

  double distance_m_;
  std::vector<std::uint32_t> heads_, next_;
  std::vector<glm::dvec3> position_m_;
  std::vector<glm::vec3> normal_;
};

}  // namespace

double areaOf_m2(const std::vector<glm::vec3>& corners_m) {
  const std::vector<double> sums = summedAreas(corners_m);
  return sums.empty() ? 0.0 : sums.back();
}

std::vector<MeshPoint> poissonDisk(const std::vector<glm::vec3>& corners_m, double spacing_m) {
  assert(spacing_m > 0.0);
  const std::vector<double> sums = summedAreas(corners_m);
  if (sums.empty() || !(sums.back() > 0.0)) return {};
  const double wanted = std::ceil(sums.back() / (spacing_m * spacing_m));
  assert(wanted <= 1e8);

  std::mt19937_64 random(1);
  const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  Grid grid(static_cast<std::size_t>(wanted), kPoissonDistance * spacing_m);
  std::vector<MeshPoint> points;
  for (double dart = 0.0; dart < kDartsAPoint * wanted; ++dart) {
    if (static_cast<double>(points.size()) >= kMost * wanted) break;
    const auto hit = std::upper_bound(sums.begin(), sums.end(), uniform() * sums.back());
    const auto triangle = static_cast<std::size_t>(std::min(hit, sums.end() - 1) - sums.begin());
    glm::dvec2 weights(uniform(), uniform());
    if (weights.x + weights.y > 1.0) weights = 1.0 - weights;
    const glm::dvec3 cross = crossOf(corners_m, triangle);
    const double length = glm::length(cross);
    if (!(length > 0.0)) continue;  // the last one, by rounding
    const glm::dvec3 a = corners_m[3 * triangle];
    const glm::dvec3 p = a + weights.x * (glm::dvec3(corners_m[3 * triangle + 1]) - a) +
                         weights.y * (glm::dvec3(corners_m[3 * triangle + 2]) - a);
    const glm::vec3 normal(cross / length);
    if (!grid.isFree(p, normal)) continue;
    grid.add(p, normal);
    points.push_back({static_cast<std::uint32_t>(triangle), glm::vec2(weights)});
  }
  return points;
}

}  // namespace foci
