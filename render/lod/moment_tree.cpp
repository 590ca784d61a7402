#include "render/lod/moment_tree.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <type_traits>

#include "base/parallel.h"

namespace foci {
namespace {

constexpr std::size_t kMinCluster = 3;

using Item = TreeItem<glm::vec3>;
using Sums = NodeSums;

Sums sumsOf(const SurfelCloud& cloud, std::size_t i) {
  Sums sums;
  const glm::dvec3 u(cloud.axis_u_m[i]), v(cloud.axis_v_m[i]);
  const double opacity = double{opacityOf(cloud, i)};
  sums.area = cloud.area_m2[i];
  sums.opaque_area = sums.area * opacity;
  sums.weight =
      std::max(sums.opaque_area, 1e-6 * sums.area);  // positive even if all surfels are transparent
  sums.mean = glm::dvec3(cloud.position_m[i]);
  const double variance[6] = {u.x * u.x + v.x * v.x, u.x * u.y + v.x * v.y, u.x * u.z + v.x * v.z,
                              u.y * u.y + v.y * v.y, u.y * u.z + v.y * v.z, u.z * u.z + v.z * v.z};
  std::copy_n(variance, 6, sums.variance);
  sums.own_trace = variance[0] + variance[3] + variance[5];
  sums.color = glm::dvec3(cloud.color[i]);
  const glm::dvec3 normal = glm::cross(u, v);
  sums.normal = normal * (sums.area / std::max(glm::length(normal), 1e-300));
  if (!cloud.bodies.of_surfel.empty() && cloud.bodies.of_surfel[i] != 0) {
    sums.closed_area = sums.area;
    sums.closed_facing = sums.normal;
  }
  sums.radius = 3.0 * std::sqrt(std::max(glm::dot(u, u), glm::dot(v, v)));
  return sums;
}

Sums merged(const Sums& a, const Sums& b) {
  Sums sums;
  sums.area = a.area + b.area;
  sums.opaque_area = a.opaque_area + b.opaque_area;
  sums.weight = a.weight + b.weight;
  const double fa = a.weight / sums.weight, fb = b.weight / sums.weight;
  sums.mean = fa * a.mean + fb * b.mean;
  const glm::dvec3 d = b.mean - a.mean;
  const double between[6] = {d.x * d.x, d.x * d.y, d.x * d.z, d.y * d.y, d.y * d.z, d.z * d.z};
  for (int k = 0; k < 6; ++k) {
    sums.variance[k] = fa * a.variance[k] + fb * b.variance[k] + fa * fb * between[k];
  }
  sums.own_trace = fa * a.own_trace + fb * b.own_trace;
  sums.color = fa * a.color + fb * b.color;
  // Both sides of a thin body: their axis counts, not their signs.
  sums.normal = glm::dot(a.normal, b.normal) < 0.0 ? a.normal - b.normal : a.normal + b.normal;
  sums.closed_area = a.closed_area + b.closed_area;
  sums.closed_facing = a.closed_facing + b.closed_facing;
  sums.radius = std::max(glm::length(sums.mean - a.mean) + a.radius,
                         glm::length(sums.mean - b.mean) + b.radius);
  return sums;
}

LodNode nodeOf(const Sums& sums) {
  LodNode node{};
  node.position_m = glm::vec3(sums.mean);
  const double* v = sums.variance;
  for (int k = 0; k < 6; ++k) node.variance_m2[k] = static_cast<float>(v[k]);
  const double minors = std::max(0.0, v[0] * v[3] - v[1] * v[1]) +
                        std::max(0.0, v[0] * v[5] - v[2] * v[2]) +
                        std::max(0.0, v[3] * v[5] - v[4] * v[4]);
  node.density = static_cast<float>(seenArea_m2(sums) / std::sqrt(std::max(minors, 1e-300)));
  node.color = glm::vec3(sums.color);
  node.radius_m = static_cast<float>(sums.radius) * (1.0f + 1e-6f);
  packNormal(glm::vec3(sums.normal / std::max(glm::length(sums.normal), 1e-300)), node.normal);
  const auto fraction = [](double f) {
    return static_cast<std::uint16_t>(std::lround(65535.0 * std::clamp(f, 0.0, 1.0)));
  };
  node.opacity = fraction(sums.opaque_area / sums.area);
  node.own = fraction(sums.own_trace / std::max(v[0] + v[3] + v[5], 1e-300));
  return node;
}

/// Makes the nodes of a subtree.
Sums sumBelow(const SurfelCloud& surfels, std::vector<LodNode>& nodes, int levels, int level,
              std::size_t j) {
  Sums sums;
  if (level + 1 == levels) {
    const auto [begin, end] = rangeBelow(surfels.size(), level, j);
    sums = sumsOf(surfels, begin);
    for (std::size_t i = begin + 1; i < end; ++i) {
      sums = merged(sums, sumsOf(surfels, i));
    }
  } else {
    sums = merged(sumBelow(surfels, nodes, levels, level + 1, 2 * j),
                  sumBelow(surfels, nodes, levels, level + 1, 2 * j + 1));
  }
  nodes[(std::size_t{1} << level) + j] = nodeOf(sums);
  return sums;
}

template <typename T>
void gather(const MappedVector<T>& from, const std::vector<Item>& items, MappedVector<T>& into) {
  if (from.empty()) return;
  std::vector<T>& to = into.own();
  to.resize(items.size());
  constexpr std::size_t kBlock = 1 << 16;
  parallelFor((items.size() + kBlock - 1) / kBlock, [&](std::size_t b) {
    const std::size_t end = std::min(items.size(), (b + 1) * kBlock);
    for (std::size_t i = b * kBlock; i < end; ++i) to[i] = from[items[i].index];
  });
}

Coarseness coarsenessOf(const LodNode& node) {
  const glm::vec3 normal = unpackNormal(node.normal);
  const float coarse_m2 = node.added_m2() + MomentTree::kThick * node.covariance_m2(normal, normal);
  return {coarse_m2, coarse_m2};
}

std::optional<Scene> sortedByTree(const SurfelCloud& cloud) { return Scene{withTree(cloud)}; }
std::optional<Scene> sortedByTree(const GaussianCloud& /*cloud*/) { return std::nullopt; }

/// The tree of a large scene; else null.
std::shared_ptr<const MomentTree> largeTree(const SurfelCloud& cloud, std::size_t large) {
  return cloud.size() > large ? builtTree(cloud) : nullptr;
}
std::shared_ptr<const MomentTree> largeTree(const GaussianCloud& /*cloud*/, std::size_t /*large*/) {
  return nullptr;
}
std::shared_ptr<const MomentTree> largeTree(const Scene& scene, std::size_t large) {
  return std::visit([&](const auto& cloud) { return largeTree(cloud, large); }, scene.splats);
}

}  // namespace

double seenArea_m2(const NodeSums& sums) {
  return sums.area - 0.5 * (sums.closed_area - glm::length(sums.closed_facing));
}

void packNormal(const glm::vec3& normal, std::int16_t packed[2]) {
  const float sum = std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z);
  glm::vec2 p = sum > 0.0f ? glm::vec2(normal) / sum : glm::vec2(0.0f);
  if (normal.z < 0.0f) {
    p = glm::vec2(std::copysign(1.0f - std::abs(p.y), p.x),
                  std::copysign(1.0f - std::abs(p.x), p.y));
  }
  packed[0] = static_cast<std::int16_t>(std::lround(32767.0f * p.x));
  packed[1] = static_cast<std::int16_t>(std::lround(32767.0f * p.y));
}

glm::vec3 unpackNormal(const std::int16_t packed[2]) {
  const float x = static_cast<float>(packed[0]) / 32767.0f;
  const float y = static_cast<float>(packed[1]) / 32767.0f;
  const float z = 1.0f - std::abs(x) - std::abs(y);
  const float fold = std::max(-z, 0.0f);
  return glm::normalize(glm::vec3(x - std::copysign(fold, x), y - std::copysign(fold, y), z));
}

int MomentTree::levelsOf(std::size_t n) {
  return n == 0 ? 0 : static_cast<int>(std::bit_width(std::max<std::size_t>(n / kMinCluster, 1)));
}

MomentTree::MomentTree(const SurfelCloud& cloud) : levels_(levelsOf(cloud.size())) {
  const std::size_t n = cloud.size();
  assert(n < std::size_t{1} << 31);
  surfels_.oriented = cloud.oriented;
  if (n == 0) return;

  std::vector<Item> items(n);
  parallelFor(n, [&](std::size_t i) {
    items[i] = {cloud.position_m[i], static_cast<std::uint32_t>(i)};
  });
  sortIntoTree(items, levels_);
  gather(cloud.position_m, items, surfels_.position_m);
  gather(cloud.axis_u_m, items, surfels_.axis_u_m);
  gather(cloud.axis_v_m, items, surfels_.axis_v_m);
  gather(cloud.color, items, surfels_.color);
  gather(cloud.opacity, items, surfels_.opacity);
  gather(cloud.area_m2, items, surfels_.area_m2);
  gather(cloud.bodies.of_surfel, items, surfels_.bodies.of_surfel);
  surfels_.bodies.boxes = cloud.bodies.boxes;
  gather(cloud.objects.of, items, surfels_.objects.of);
  surfels_.objects.names = cloud.objects.names;

  nodes_.resize(std::size_t{1} << levels_);
  const int serial = std::min(kSerialLevels, levels_ - 1);
  std::vector<Sums> sums(std::size_t{1} << serial);
  parallelFor(sums.size(),
              [&](std::size_t j) { sums[j] = sumBelow(surfels_, nodes_, levels_, serial, j); });
  for (int level = serial - 1; level >= 0; --level) {
    for (std::size_t j = 0; j < std::size_t{1} << level; ++j) {
      sums[j] = merged(sums[2 * j], sums[2 * j + 1]);
      nodes_[(std::size_t{1} << level) + j] = nodeOf(sums[j]);
    }
  }

  sums_ = sums[0];

  coarseness_.resize(nodes_.size());
  parallelFor(nodes_.size(), [&](std::size_t i) { coarseness_[i] = coarsenessOf(nodes_[i]); });
  for (std::size_t node = nodes_.size() / 2; node-- > 1;) {
    coarseness_[node].min_m2 =
        std::min(coarseness_[2 * node].min_m2, coarseness_[2 * node + 1].min_m2);
  }
  view_ = {nodes_, coarseness_, {}};
  if (surfels_.bodies.boxes.empty()) return;
  findFacing();
  view_.facing = facing_;
}

MomentTree::MomentTree(SurfelCloud surfels, const TreeNodes& nodes,
                       std::shared_ptr<const void> keep)
    : surfels_(std::move(surfels)),
      keep_(std::move(keep)),
      view_(nodes),
      levels_(levelsOf(surfels_.size())) {
  assert(view_.nodes.size() == std::size_t{1} << levels_);
}

TreeTop topOf(std::span<const TreeRoot> roots) {
  assert(std::has_single_bit(roots.size()));
  TreeTop top{std::vector<LodNode>(roots.size()), std::vector<Coarseness>(roots.size())};
  std::vector<TreeRoot> below(roots.begin(), roots.end());
  for (std::size_t count = roots.size() / 2; count > 0; count /= 2) {
    for (std::size_t j = 0; j < count; ++j) {
      const TreeRoot &a = below[2 * j], &b = below[2 * j + 1];
      const Sums sums = merged(a.sums, b.sums);
      top.nodes[count + j] = nodeOf(sums);
      Coarseness& coarse = top.coarseness[count + j] = coarsenessOf(top.nodes[count + j]);
      coarse.min_m2 = std::min(a.min_m2, b.min_m2);
      below[j] = {sums, coarse.min_m2};
    }
  }
  return top;
}

SurfelCloud surfelsOf(std::shared_ptr<const MomentTree> tree) {
  const SurfelCloud& surfels = tree->surfels();
  const auto shared = [&tree](const auto& values) {
    using Values = std::remove_cvref_t<decltype(values)>;
    return values.empty() ? Values{} : Values({values.data(), values.size()}, tree);
  };
  return {.position_m = shared(surfels.position_m),
          .axis_u_m = shared(surfels.axis_u_m),
          .axis_v_m = shared(surfels.axis_v_m),
          .color = shared(surfels.color),
          .opacity = shared(surfels.opacity),
          .area_m2 = shared(surfels.area_m2),
          .oriented = surfels.oriented,
          .bodies = {.of_surfel = shared(surfels.bodies.of_surfel), .boxes = surfels.bodies.boxes},
          .objects = {.of = shared(surfels.objects.of), .names = surfels.objects.names},
          .tree = BuiltTree(tree)};
}

std::shared_ptr<const MomentTree> builtTree(const SurfelCloud& cloud) {
  const std::shared_ptr<const MomentTree>& tree = cloud.tree.tree_;
  if (!tree) return nullptr;
  const SurfelCloud& of = tree->surfels();
  const auto shared = [](const auto& a, const auto& b) {
    return a.size() == b.size() && (a.empty() || a.data() == b.data());
  };
  const bool unchanged =
      shared(cloud.position_m, of.position_m) && shared(cloud.axis_u_m, of.axis_u_m) &&
      shared(cloud.axis_v_m, of.axis_v_m) && shared(cloud.color, of.color) &&
      shared(cloud.opacity, of.opacity) && shared(cloud.area_m2, of.area_m2) &&
      shared(cloud.bodies.of_surfel, of.bodies.of_surfel) && cloud.oriented == of.oriented;
  return unchanged ? tree : nullptr;
}

SurfelCloud withTree(const SurfelCloud& cloud) {
  if (builtTree(cloud)) return cloud;
  SurfelCloud sorted = surfelsOf(std::make_shared<const MomentTree>(cloud));
  sorted.mesh = cloud.mesh;
  return sorted;
}

std::optional<Scene> withSurfelTree(const Scene& scene) {
  return std::visit([](const auto& cloud) { return sortedByTree(cloud); }, scene.splats);
}

std::shared_ptr<const MomentTree> treeOf(const SurfelCloud& cloud) {
  auto tree = builtTree(cloud);
  return tree ? tree : std::make_shared<const MomentTree>(cloud);
}

/// From the clusters up. The cone of a node holds those of its children.
void MomentTree::findFacing() {
  facing_.resize(nodes_.size());
  std::vector<double> cone_rad(nodes_.size());
  const auto angle = [](const glm::vec3& a, const glm::vec3& b) {
    return std::acos(std::clamp(glm::dot(glm::dvec3(a), glm::dvec3(b)), -1.0, 1.0));
  };
  const auto put = [&](std::size_t node, std::uint16_t body, double rad) {
    constexpr double kRounding_rad = 1e-3;  // of the angles
    cone_rad[node] = rad;
    const double cosine = std::cos(std::min(rad + kRounding_rad, std::numbers::pi));
    facing_[node] = {body, static_cast<std::uint16_t>(std::max(std::floor(65535.0 * cosine), 0.0))};
  };
  const std::size_t clusters = nodes_.size() / 2;
  parallelFor(clusters, [&](std::size_t j) {
    const auto [begin, end] = range(levels_ - 1, j);
    const glm::vec3 mean = unpackNormal(nodes_[clusters + j].normal);
    std::uint16_t body = surfels_.bodies.of_surfel[begin];
    double rad = 0.0;
    for (std::size_t i = begin; i < end; ++i) {
      if (surfels_.bodies.of_surfel[i] != body) body = Facing::kSeveral;
      const glm::dvec3 across =
          glm::cross(glm::dvec3(surfels_.axis_u_m[i]), glm::dvec3(surfels_.axis_v_m[i]));
      rad = std::max(rad, angle(mean, glm::vec3(glm::normalize(across))));
    }
    put(clusters + j, body, rad);
  });
  for (std::size_t node = clusters; node-- > 1;) {
    const glm::vec3 mean = unpackNormal(nodes_[node].normal);
    double rad = 0.0;
    for (const std::size_t child : {2 * node, 2 * node + 1}) {
      rad = std::max(rad, angle(mean, unpackNormal(nodes_[child].normal)) + cone_rad[child]);
    }
    const std::uint16_t body = facing_[2 * node].body;
    put(node, body == facing_[2 * node + 1].body ? body : Facing::kSeveral, rad);
  }
}

bool isLarge(const Scene& scene) { return largeTree(scene, kLargeScene) != nullptr; }

std::optional<Scene> outlineOf(const Scene& scene, std::size_t large) {
  constexpr int kLevel = 16;
  const auto tree = largeTree(scene, large);
  if (!tree) return std::nullopt;
  SurfelCloud outline;
  const std::size_t first = std::size_t{1} << std::min(kLevel, tree->levels() - 1);
  for (std::size_t i = first; i < 2 * first; ++i) {
    const LodNode& node = tree->nodes()[i];
    appendSurfel(outline, node.position_m, unpackNormal(node.normal), node.radius_m / 3.0f,
                 node.density * node.trace_m2(), node.color,
                 static_cast<float>(node.opacity) * (1.0f / 65535.0f));
  }
  outline.oriented = tree->surfels().oriented;
  return Scene{std::move(outline)};
}

}  // namespace foci
