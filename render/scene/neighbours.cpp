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

/// A result set for nanoflann: the k nearest points besides the query itself. Unlike nanoflann's
/// own it stops as soon as k points coincide with the query. A cloud in one spot would otherwise
/// take quadratic time.
class Nearest {
 public:
  using DistanceType = float;
  using IndexType = std::uint32_t;
  /// @param within2  squared distance within which there are k
  Nearest(std::size_t k, std::uint32_t self, float within2)
      : k_(k), self_(self), within2_(within2) {}

  std::size_t size() const { return count_; }
  bool full() const { return count_ == k_; }
  float worstDist() const {
    if (!full()) return within2_;
    return furthest2_ > 0.0f ? furthest2_ : -1.0f;
  }
  bool addPoint(float distance2, std::uint32_t index) {
    if (index == self_ || (full() ? distance2 >= furthest2_ : distance2 > within2_)) return true;
    std::size_t at = full() ? k_ - 1 : count_++;
    for (; at > 0 && distance2_[at - 1] > distance2; --at) {
      distance2_[at] = distance2_[at - 1];
      index_[at] = index_[at - 1];
    }
    distance2_[at] = distance2;
    index_[at] = index;
    furthest2_ = distance2_[count_ - 1];
    return true;
  }
  void sort() {}  // they are
  void copyTo(std::uint32_t* index, float& reach_m) const {
    for (std::size_t i = 0; i < count_; ++i) index[i] = index_[i];
    reach_m = std::sqrt(furthest2_);
  }

 private:
  std::size_t k_, count_ = 0;
  std::uint32_t self_;
  float within2_, furthest2_ = 0.0f;
  std::array<float, kMaxNeighbours> distance2_{};
  std::array<std::uint32_t, kMaxNeighbours> index_{};
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
  Tree tree(3, positions, nanoflann::KDTreeSingleIndexAdaptorParams(12));
  found.index.resize(position_m.size() * found.k);
  found.reach_m.resize(position_m.size());
  // In the tree's order, consecutive queries read the same memory, and what one of them finds is
  // near the next one, too.
  constexpr std::size_t kBlock = 256;
  parallelFor((position_m.size() + kBlock - 1) / kBlock, [&](std::size_t block) {
    float within2 = std::numeric_limits<float>::max();
    for (std::size_t at = block * kBlock; at < std::min(position_m.size(), (block + 1) * kBlock);
         ++at) {
      const std::uint32_t i = orderOf(tree)[at];
      if (at != block * kBlock) {
        constexpr float kRounding = 1.0001f;
        const std::uint32_t last = orderOf(tree)[at - 1];
        const float within_m =
            kRounding * (found.reach_m[last] + glm::distance(position_m[i], position_m[last]));
        within2 = within_m * within_m;
      }
      Nearest nearest(found.k, i, within2);
      tree.findNeighbors(nearest, &position_m[i].x, {});
      nearest.copyTo(&found.index[i * found.k], found.reach_m[i]);
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
    std::vector<glm::vec3> some_m;
    some_m.reserve(members[m].size());
    for (const std::uint32_t i : members[m]) some_m.push_back(position_m[i]);
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
  const Tree tree(3, positions, nanoflann::KDTreeSingleIndexAdaptorParams(12));
  parallelFor(centers_m.size(), [&](std::size_t i) {
    Within within(radius_m[i], max_points, found[i]);
    tree.findNeighbors(within, &centers_m[i].x, {});
  });
  return found;
}

std::vector<std::uint32_t> mortonOrder(std::span<const glm::vec3> position_m) {
  glm::vec3 low(std::numeric_limits<float>::max()), high(std::numeric_limits<float>::lowest());
  for (const glm::vec3& p : position_m) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  const glm::vec3 size = high - low;
  const float scale = kLastCell / std::max({size.x, size.y, size.z, 1e-30f});
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keys(position_m.size());
  parallelFor(position_m.size(), [&](std::size_t i) {
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
