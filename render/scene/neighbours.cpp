#include "render/scene/neighbours.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <nanoflann.hpp>
#include <numeric>
#include <utility>

#include "base/parallel.h"
#include "base/parallel_sort.h"
#include "render/scene/surfel_cloud.h"

namespace foci {
namespace {

struct Positions {
  std::span<const glm::vec3> position_m;

  std::size_t kdtree_get_point_count() const { return position_m.size(); }
  float kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return position_m[i][static_cast<int>(axis)];
  }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

using Tree = nanoflann::KDTreeSingleIndexAdaptor<
    nanoflann::L2_Simple_Adaptor<float, Positions, float, std::uint32_t>, Positions, 3,
    std::uint32_t>;

/// The points in the tree's order; nanoflann 1.5 renamed it.
template <class AnyTree>
const auto& orderOf(const AnyTree& tree) {
  if constexpr (requires { tree.vAcc_; }) {
    return tree.vAcc_;
  } else {
    return tree.vAcc;
  }
}

template <class AnyTree>
const auto* rootOf(const AnyTree& tree) {
  if constexpr (requires { tree.root_node_; }) {
    return tree.root_node_;
  } else {
    return tree.root_node;
  }
}

constexpr std::uint32_t kLeaf = 12;  // points, at most

/// nanoflann's search of a tree for the k nearest points besides the query, for the points of the
/// tree themselves. Distances of a whole leaf are taken at once. Of points at equal distances those
/// come first that the search meets first.
class NearestSearch {
 public:
  NearestSearch(const Tree& tree, std::span<const glm::vec3> position_m, std::size_t k)
      : tree_(tree), k_(static_cast<std::uint32_t>(k)) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      place_m_[axis].resize(position_m.size() + kLeaf);
      parallelFor(position_m.size(), [&](std::size_t at) {
        place_m_[axis][at] = position_m[orderOf(tree)[at]][static_cast<int>(axis)];
      });
    }
  }

  /// @param at        of the query, in the tree's order
  /// @param within_m  distance within which there may be k
  /// @return whether there are
  bool find(std::size_t at, float within_m, std::uint32_t* index, float& reach_m) const {
    Met met;
    met.self = at;
    met.p_m = {place_m_[0][at], place_m_[1][at], place_m_[2][at]};
    met.below2 = std::max(within_m * within_m, std::numeric_limits<float>::min());
    visit(*rootOf(tree_), 0.0f, glm::vec3(0.0f), met);
    if (met.count < k_) return false;
    keepNearest(met);
    for (std::size_t i = 0; i < k_; ++i) index[i] = orderOf(tree_)[met.at[i]];
    reach_m = std::sqrt(met.distance2[k_ - 1]);
    return true;
  }

 private:
  static constexpr std::size_t kMostMet = 2 * kMaxNeighbours + 3 * kLeaf;

  /// The query, and the points near it.
  struct Met {
    std::size_t self;
    glm::vec3 p_m;
    float below2;  ///< squared distance of the points that count
    std::uint32_t count = 0;
    std::array<float, kMostMet> distance2;
    std::array<std::uint32_t, kMostMet> at;
  };

  /// @param least2   squared distance of the node
  /// @param beside2  its parts along the axes
  template <class Node>
  void visit(const Node& node, float least2, glm::vec3 beside2, Met& met) const {
    if (node.child1 == nullptr) return look(node.node_type.lr.left, node.node_type.lr.right, met);
    const auto axis = node.node_type.sub.divfeat;
    const float low = met.p_m[axis] - node.node_type.sub.divlow;
    const float high = met.p_m[axis] - node.node_type.sub.divhigh;
    const bool in_first = low + high < 0.0f;
    visit(in_first ? *node.child1 : *node.child2, least2, beside2, met);
    const float cut2 = in_first ? high * high : low * low;
    least2 = least2 + cut2 - beside2[axis];
    if (least2 >= met.below2) return;
    beside2[axis] = cut2;
    visit(in_first ? *node.child2 : *node.child1, least2, beside2, met);
  }

  void look(std::size_t from, std::size_t to, Met& met) const {
    std::array<float, kLeaf> distance2;
    for (std::size_t i = 0; i < kLeaf; ++i) {
      const float x = met.p_m.x - place_m_[0][from + i], y = met.p_m.y - place_m_[1][from + i],
                  z = met.p_m.z - place_m_[2][from + i];
      distance2[i] = x * x + y * y + z * z;
    }
    for (std::size_t i = 0; from + i < to; ++i) {
      met.distance2[met.count] = distance2[i];
      met.at[met.count] = static_cast<std::uint32_t>(from + i);
      met.count += distance2[i] < met.below2 && from + i != met.self;
    }
    if (met.count > 2 * k_ + kLeaf) keepNearest(met);
  }

  /// Keeps the k nearest, in order. From then on, only nearer ones count.
  void keepNearest(Met& met) const {
    constexpr std::uint32_t kStep = 8;
    const std::uint32_t count = met.count, end = (count + kStep - 1) / kStep * kStep;
    std::array<float, kMostMet> distance2;
    std::array<std::uint32_t, kMostMet> at;
    std::array<std::uint8_t, kMostMet> equal;
    std::copy_n(met.distance2.begin(), count, distance2.begin());
    std::fill(distance2.begin() + count, distance2.begin() + end, met.below2);
    std::copy_n(met.at.begin(), count, at.begin());
    std::fill_n(equal.begin(), count, std::uint8_t{0});
    for (std::uint32_t i = 0; i < count; ++i) {
      std::uint32_t nearer = 0;
      for (std::uint32_t j = 0; j < end; ++j) nearer += distance2[j] < distance2[i];
      const std::uint32_t rank = nearer + equal[nearer]++;
      met.distance2[rank] = distance2[i];
      met.at[rank] = at[i];
    }
    met.count = std::min(count, k_);
    if (met.count == k_) met.below2 = met.distance2[k_ - 1];
  }

  const Tree& tree_;
  std::uint32_t k_;
  std::array<std::vector<float>, 3> place_m_;  // by axis, in the tree's order
};

/// A result set for nanoflann: points within a radius, up to a maximum number.
class Within {
 public:
  using DistanceType = float;
  using IndexType = std::uint32_t;
  Within(float radius_m, std::size_t max_points, std::vector<std::uint32_t>& found)
      : radius2_(radius_m * radius_m), max_points_(max_points), found_(found) {}

  std::size_t size() const { return found_.size(); }
  bool full() const { return true; }
  float worstDist() const { return radius2_; }
  bool addPoint(float distance2, std::uint32_t index) {
    if (distance2 < radius2_ && found_.size() < max_points_) found_.push_back(index);
    return found_.size() < max_points_;
  }
  void sort() {}  // in any order

 private:
  float radius2_;
  std::size_t max_points_;
  std::vector<std::uint32_t>& found_;
};

constexpr float kLastCell = 2097151.0f;  // 2^21 - 1

/// Spreads the low 21 bits to every third bit.
std::uint64_t spread(std::uint64_t x) {
  x &= 0x1fffff;
  x = (x | x << 32) & 0x1f00000000ffff;
  x = (x | x << 16) & 0x1f0000ff0000ff;
  x = (x | x << 8) & 0x100f00f00f00f00f;
  x = (x | x << 4) & 0x10c30c30c30c30c3;
  return (x | x << 2) & 0x1249249249249249;
}

}  // namespace

Neighbours findNeighbours(std::span<const glm::vec3> position_m, std::size_t wanted) {
  assert(wanted <= kMaxNeighbours);
  assert(position_m.size() < std::numeric_limits<std::uint32_t>::max());
  Neighbours found;
  found.k = std::min(wanted, position_m.empty() ? 0 : position_m.size() - 1);
  if (found.k == 0) return found;

  const Positions positions{position_m};
  const Tree tree(3, positions, nanoflann::KDTreeSingleIndexAdaptorParams(kLeaf));
  const NearestSearch search(tree, position_m, found.k);
  found.index.resize(position_m.size() * found.k);
  found.reach_m.resize(position_m.size());
  // In the tree's order, consecutive queries read the same memory, and what one of them finds is
  // near the next one, too.
  constexpr std::size_t kBlock = 256;
  parallelFor((position_m.size() + kBlock - 1) / kBlock, [&](std::size_t block) {
    float likely_m = std::numeric_limits<float>::infinity();
    for (std::size_t at = block * kBlock; at < std::min(position_m.size(), (block + 1) * kBlock);
         ++at) {
      const std::uint32_t i = orderOf(tree)[at];
      std::uint32_t* const index = &found.index[i * found.k];
      if (!search.find(at, likely_m, index, found.reach_m[i]) && at != block * kBlock) {
        constexpr float kRounding = 1.0001f;
        const std::uint32_t last = orderOf(tree)[at - 1];
        search.find(
            at, kRounding * (found.reach_m[last] + glm::distance(position_m[i], position_m[last])),
            index, found.reach_m[i]);
      }
      constexpr float kLikely = 1.1f;
      likely_m = kLikely * found.reach_m[i];
    }
  });
  return found;
}

Neighbours findNeighbours(std::span<const glm::vec3> position_m,
                          std::span<const std::uint32_t> group, std::size_t wanted) {
  std::vector<std::uint32_t> order(group.size());
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::stable_sort(order, {}, [&](std::uint32_t i) { return group[i]; });
  std::vector<std::span<const std::uint32_t>> members;
  const std::span<const std::uint32_t> all(order);
  for (std::size_t from = 0, to = 1; to <= order.size(); ++to) {
    const bool last = to == order.size();
    if (!last && (group[order[to]] == group[order[to - 1]] || to - from <= wanted)) continue;
    if (to - from <= wanted && !members.empty()) {
      from -= members.back().size();
      members.pop_back();
    }
    members.push_back(all.subspan(from, to - from));
    from = to;
  }
  if (members.size() < 2) return findNeighbours(position_m, wanted);

  Neighbours found;
  found.k = wanted;
  found.index.resize(position_m.size() * wanted);
  found.reach_m.resize(position_m.size());
  parallelFor(members.size(), [&](std::size_t m) {
    const std::vector<glm::vec3> some_m = picked(position_m, members[m]);
    const Neighbours among = findNeighbours(some_m, wanted);
    for (std::size_t n = 0; n < some_m.size(); ++n) {
      const std::size_t i = members[m][n];
      std::ranges::transform(among.of(n), &found.index[i * wanted],
                             [&](std::uint32_t j) { return members[m][j]; });
      found.reach_m[i] = among.reach_m[n];
    }
  });
  return found;
}

std::vector<std::vector<std::uint32_t>> findWithin(std::span<const glm::vec3> position_m,
                                                   std::span<const glm::vec3> centers_m,
                                                   std::span<const float> radius_m,
                                                   std::size_t max_points) {
  std::vector<std::vector<std::uint32_t>> found(centers_m.size());
  if (position_m.empty()) return found;
  const Positions positions{position_m};
  const Tree tree(3, positions, nanoflann::KDTreeSingleIndexAdaptorParams(kLeaf));
  parallelFor(centers_m.size(), [&](std::size_t i) {
    Within within(radius_m[i], max_points, found[i]);
    tree.findNeighbors(within, &centers_m[i].x, {});
  });
  return found;
}

std::vector<std::uint32_t> mortonOrder(std::span<const glm::vec3> position_m) {
  if (position_m.empty()) return {};
  const auto [low, high] = boxOf(position_m);
  const glm::vec3 size = high - low;
  const float scale = kLastCell / std::max({size.x, size.y, size.z, 1e-30f});
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keys(position_m.size());
  parallelFor(position_m.size(), [&, low = low](std::size_t i) {
    const glm::vec3 cell = glm::min((position_m[i] - low) * scale, kLastCell);
    const auto part = [](float x) { return spread(static_cast<std::uint64_t>(x)); };
    keys[i] = {part(cell.x) | part(cell.y) << 1 | part(cell.z) << 2, static_cast<std::uint32_t>(i)};
  });
  parallelSort(keys.begin(), keys.end());
  std::vector<std::uint32_t> order(keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i) order[i] = keys[i].second;
  return order;
}

}  // namespace foci
