#include "render/scene/io/triangulate.h"

#include <cmath>
#include <utility>

namespace foci {
namespace {

constexpr std::size_t kMaxEarCorners = 1024;  // ears take quadratic time

/// Twice the signed area.
double turn(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// The corners along the two axes across which the polygon is largest, counter-clockwise.
std::vector<glm::dvec2> flattened(std::span<const glm::dvec3> corners) {
  glm::dvec3 normal(0.0);  // Newell's: twice the area
  for (std::size_t i = 0; i < corners.size(); ++i) {
    normal += glm::cross(corners[i] - corners[0], corners[(i + 1) % corners.size()] - corners[0]);
  }
  int drop = 0;
  for (int axis = 1; axis < 3; ++axis) {
    if (std::abs(normal[axis]) > std::abs(normal[drop])) drop = axis;
  }
  const int first = (drop + 1) % 3, second = (drop + 2) % 3;
  const double sign = normal[drop] < 0.0 ? -1.0 : 1.0;
  std::vector<glm::dvec2> flat;
  flat.reserve(corners.size());
  for (const glm::dvec3& p : corners) flat.emplace_back(p[first], sign * p[second]);
  return flat;
}

/// The polygon that is left, as a ring of its corners.
class Ring {
 public:
  explicit Ring(std::vector<glm::dvec2> flat) : flat_(std::move(flat)) {
    const auto count = static_cast<std::uint32_t>(flat_.size());
    before_.resize(count);
    after_.resize(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      before_[i] = (i + count - 1) % count;
      after_[i] = (i + 1) % count;
    }
  }

  std::uint32_t before(std::uint32_t i) const { return before_[i]; }
  std::uint32_t after(std::uint32_t i) const { return after_[i]; }

  /// Whether the triangle at a corner lies inside the polygon and holds no other corner.
  bool isEar(std::uint32_t i) const {
    const glm::dvec2 &a = flat_[before_[i]], &b = flat_[i], &c = flat_[after_[i]];
    if (turn(a, b, c) <= 0.0) return false;
    for (std::uint32_t k = after_[after_[i]]; k != before_[i]; k = after_[k]) {
      const glm::dvec2& p = flat_[k];
      if (p == a || p == b || p == c) continue;
      if (turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0) return false;
    }
    return true;
  }

  bool isConvex() const {
    for (std::uint32_t i = 0; i < flat_.size(); ++i) {
      if (turn(flat_[before_[i]], flat_[i], flat_[after_[i]]) < 0.0) return false;
    }
    return true;
  }

  void cut(std::uint32_t i) {
    after_[before_[i]] = after_[i];
    before_[after_[i]] = before_[i];
  }

 private:
  std::vector<glm::dvec2> flat_;
  std::vector<std::uint32_t> before_, after_;
};

}  // namespace

std::vector<std::array<std::uint32_t, 3>> triangulate(std::span<const glm::dvec3> corners) {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  if (corners.size() < 3) return triangles;
  const auto count = static_cast<std::uint32_t>(corners.size());
  triangles.reserve(count - 2);
  Ring ring(flattened(corners));
  std::uint32_t at = 0;
  if (count > 3 && count <= kMaxEarCorners && !ring.isConvex()) {
    std::vector<std::uint8_t> ear(count);  // a cut changes those of its two neighbours
    for (std::uint32_t i = 0; i < count; ++i) ear[i] = ring.isEar(i);
    std::uint32_t refused = 0;
    for (std::uint32_t left = count; left > 3 && refused < left;) {
      if (ear[at] == 0) {
        at = ring.after(at);
        ++refused;
        continue;
      }
      const std::uint32_t before = ring.before(at), after = ring.after(at);
      triangles.push_back({before, at, after});
      ring.cut(at);
      ear[before] = ring.isEar(before);
      ear[after] = ring.isEar(after);
      --left;
      refused = 0;
      at = ring.after(after);  // not `after`: slivers around one corner would result
    }
  }
  // A triangle, a convex polygon, or what has no ears.
  const std::uint32_t first = at;
  for (std::uint32_t i = ring.after(first); ring.after(i) != first; i = ring.after(i)) {
    triangles.push_back({first, i, ring.after(i)});
  }
  return triangles;
}

}  // namespace foci
