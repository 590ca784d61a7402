#include "render/literature/paper/hierarchy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/parallel.h"
#include "render/scene/tree_order.h"

namespace foci {
namespace {

constexpr std::size_t kChildren = 4;
/// The smallest ratio of a node's lesser variance to the sum of both. Chosen by hand: a thousandth
/// of the length keeps the matrix invertible.
constexpr float kMinVarianceRatio = 1e-6f;

/// A symmetric 3x3 matrix: xx, xy, xz, yy, yz, zz.
using Symmetric = std::array<float, 6>;

void addOuter(Symmetric& sum, const glm::vec3& a, float scale) {
  const glm::vec3 s = scale * a;
  const Symmetric outer = {s.x * a.x, s.x * a.y, s.x * a.z, s.y * a.y, s.y * a.z, s.z * a.z};
  for (int i = 0; i < 6; ++i) sum[i] += outer[i];
}

float quadratic(const Symmetric& m, const glm::vec3& a, const glm::vec3& b) {
  return a.x * (m[0] * b.x + m[1] * b.y + m[2] * b.z) +
         a.y * (m[1] * b.x + m[3] * b.y + m[4] * b.z) +
         a.z * (m[2] * b.x + m[4] * b.y + m[5] * b.z);
}

/// Sums over surfels, weighted by area; `mean_m` is a mean.
struct Moments {
  float area_m2 = 0.0f;
  glm::vec3 mean_m{0.0f};
  glm::vec3 normal{0.0f};
  Symmetric basis{}, spread{};
  glm::vec3 color{0.0f};  // times opacity
  float opacity = 0.0f;
  float widest_m = 0.0f;

  void add(const Moments& other) {
    const float sum = area_m2 + other.area_m2;
    const glm::vec3 apart = other.mean_m - mean_m;
    addOuter(spread, apart, area_m2 * (other.area_m2 / sum));
    mean_m += apart * (other.area_m2 / sum);
    area_m2 = sum;
    // A splat has no front: opposite normals count as equal.
    normal += glm::dot(normal, other.normal) < 0.0f ? -other.normal : other.normal;
    for (int i = 0; i < 6; ++i) {
      basis[i] += other.basis[i];
      spread[i] += other.spread[i];
    }
    color += other.color;
    opacity += other.opacity;
    widest_m = std::max(widest_m, other.widest_m);
  }
};

Moments momentsOf(const SurfelCloud& cloud, std::size_t i) {
  const glm::vec3 u = cloud.axis_u_m[i], v = cloud.axis_v_m[i];
  const float area = cloud.area_m2[i];
  const float opacity = area * opacityOf(cloud, i);
  Moments m{.area_m2 = area,
            .mean_m = cloud.position_m[i],
            .normal = area * glm::normalize(glm::cross(glm::normalize(u), glm::normalize(v))),
            .color = opacity * cloud.color[i],
            .opacity = opacity,
            .widest_m = std::max(glm::length(u), glm::length(v))};
  addOuter(m.basis, u, area);
  addOuter(m.basis, v, area);
  return m;
}

struct Axes {
  glm::vec3 u, v;
};

/// Axes with u u' + v v' = `m` in the plane of the unit vectors `x` and `y` (Cholesky).
Axes axesOf(const Symmetric& m, const glm::vec3& x, const glm::vec3& y, float min_ratio) {
  float xx = quadratic(m, x, x), yy = quadratic(m, y, y);
  const float xy = quadratic(m, x, y), min = min_ratio * (xx + yy);
  xx = std::max(xx, min);
  yy = std::max(yy, min);
  const float along = std::sqrt(xx), across = along > 0.0f ? xy / along : 0.0f;
  const float rest = std::sqrt(std::max(yy - across * across, min));
  return {along * x + across * y, rest * y};
}

PaperNode nodeOf(const Moments& m) {
  const glm::vec3 normal = glm::normalize(m.normal);
  const glm::vec3 x = tangentTo(normal), y = glm::cross(normal, x);
  Symmetric basis = m.basis, spread = m.spread;
  for (int i = 0; i < 6; ++i) {
    basis[i] /= m.area_m2;
    spread[i] /= m.area_m2;
  }
  const Axes own = axesOf(basis, x, y, kMinVarianceRatio), filter = axesOf(spread, x, y, 0.0f);
  return {.center_m = m.mean_m,  // replaced once the sphere is known
          .radius_m = 0.0f,
          .position_m = m.mean_m,
          .axis_u_m = own.u,
          .axis_v_m = own.v,
          .spread_u_m = filter.u,
          .spread_v_m = filter.v,
          .color = m.opacity > 0.0f ? m.color / m.opacity : glm::vec3(0.0f),
          .opacity = m.opacity / m.area_m2,
          .area_m2 = m.area_m2,
          .widest_m = m.widest_m};
}

bool finite(const glm::vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

bool isVisible(const SurfelCloud& cloud, std::size_t i) {
  const glm::vec3 u = cloud.axis_u_m[i], v = cloud.axis_v_m[i];
  return finite(cloud.position_m[i]) && finite(u) && finite(v) && u != glm::vec3(0.0f) &&
         v != glm::vec3(0.0f) && std::isfinite(cloud.area_m2[i]) && cloud.area_m2[i] > 0.0f;
}

}  // namespace

PaperHierarchy::PaperHierarchy(const SurfelCloud& cloud) {
  std::vector<TreeItem<glm::vec3>> items;
  items.reserve(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (isVisible(cloud, i)) items.push_back({cloud.position_m[i], static_cast<std::uint32_t>(i)});
  }
  first_ = {0};
  order_.resize(items.size());  // `surfels` reads its size
  if (items.empty()) return;
  for (std::size_t nodes = 1;; nodes *= kChildren) {
    first_.push_back(first_.back() + nodes);
    if (nodes * kChildren >= items.size()) break;
  }
  nodes_.resize(first_.back());

  sortIntoTree(items, 2 * levels() - 1);  // a binary tree, of which these are every second level
  std::vector<glm::vec3> places_m(items.size());
  parallelFor(items.size(), [&](std::size_t i) {
    order_[i] = items[i].index;
    places_m[i] = items[i].place_m;
  });

  // Go up the levels and sum moments, of the surfels first and of the children then.
  std::vector<Moments> below, here;
  for (int l = levels() - 1; l >= 0; --l) {
    here.assign(level(l).size(), {});
    parallelFor(here.size(), [&](std::size_t node) {
      const auto [begin, end] = surfels(l, node);
      if (below.empty()) {
        for (std::size_t i = begin; i < end; ++i) here[node].add(momentsOf(cloud, order_[i]));
      } else {
        for (std::size_t c = 0; c < kChildren; ++c) here[node].add(below[kChildren * node + c]);
      }
      PaperNode& out = nodes_[first_[l] + node];
      out = nodeOf(here[node]);
      const auto [low, high] = boxOf(std::span(places_m).subspan(begin, end - begin));
      out.center_m = 0.5f * (low + high);
      out.radius_m = 0.0f;
      for (std::size_t i = begin; i < end; ++i) {
        const float disc_m = std::sqrt(cloud.area_m2[order_[i]] * std::numbers::inv_pi_v<float>);
        out.radius_m = std::max(out.radius_m, glm::length(places_m[i] - out.center_m) + disc_m);
      }
    });
    std::swap(below, here);
  }
}

}  // namespace foci
