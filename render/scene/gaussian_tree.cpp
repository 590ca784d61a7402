#include "render/scene/gaussian_tree.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>

#include "base/parallel.h"
#include "render/scene/gaussian_merge.h"

namespace foci {
namespace {

constexpr std::size_t kMinCluster = 4;
constexpr int kSerialLevels = 6;  // below it one task a subtree; fixed, so results are, too

/// A Gaussian while the tree is sorted: its position and its standard deviation.
struct Item {
  glm::vec4 place_m;
  std::uint32_t gaussian;
};

/// Partitions the range [begin, end) at `middle` along its longest extent.
void partition(Item* items, std::size_t begin, std::size_t middle, std::size_t end) {
  glm::vec4 low(std::numeric_limits<float>::max()), high(std::numeric_limits<float>::lowest());
  for (std::size_t i = begin; i < end; ++i) {
    low = glm::min(low, items[i].place_m);
    high = glm::max(high, items[i].place_m);
  }
  const glm::vec4 extent = high - low;
  int axis = 0;
  for (int k = 1; k < 4; ++k) axis = extent[k] > extent[axis] ? k : axis;
  std::nth_element(
      items + begin, items + middle, items + end,
      [axis](const Item& a, const Item& b) { return a.place_m[axis] < b.place_m[axis]; });
}

class Builder {
 public:
  Builder(std::vector<Item>& items, int levels) : items_(items), levels_(levels) {}

  void sort() {
    const int serial = std::min(kSerialLevels, levels_ - 1);
    for (int level = 0; level < serial; ++level) {
      parallelFor(std::size_t{1} << level, [&](std::size_t j) { sortBelow(level, j, level + 1); });
    }
    parallelFor(std::size_t{1} << serial,
                [&](std::size_t j) { sortBelow(serial, j, levels_ - 1); });
  }

  void merge(const GaussianCloud& cloud, GaussianTree& tree) const {
    const int serial = std::min(kSerialLevels, levels_ - 1);
    std::vector<GaussianMoments> moments(std::size_t{1} << serial);
    parallelFor(moments.size(), [&](std::size_t j) { moments[j] = below(cloud, tree, serial, j); });
    for (int level = serial - 1; level >= 0; --level) {
      for (std::size_t j = 0; j < std::size_t{1} << level; ++j) {
        moments[j] = merged(moments[2 * j], moments[2 * j + 1]);
        storeNode(moments[j], tree, (std::size_t{1} << level) + j);
      }
    }
  }

 private:
  void sortBelow(int level, std::size_t j, int last_level) {
    if (level >= last_level) return;
    const auto [begin, end] = gaussiansBelow(items_.size(), level, j);
    const std::size_t middle = gaussiansBelow(items_.size(), level + 1, 2 * j).second;
    partition(items_.data(), begin, middle, end);
    sortBelow(level + 1, 2 * j, last_level);
    sortBelow(level + 1, 2 * j + 1, last_level);
  }

  /// Makes the nodes of a subtree.
  GaussianMoments below(const GaussianCloud& cloud, GaussianTree& tree, int level,
                        std::size_t j) const {
    const auto [begin, end] = gaussiansBelow(cloud.size(), level, j);
    const GaussianMoments moments = level + 1 == levels_
                                        ? ofRange(cloud, begin, end)
                                        : merged(below(cloud, tree, level + 1, 2 * j),
                                                 below(cloud, tree, level + 1, 2 * j + 1));
    storeNode(moments, tree, (std::size_t{1} << level) + j);
    return moments;
  }

  static GaussianMoments ofRange(const GaussianCloud& cloud, std::size_t begin, std::size_t end) {
    if (end - begin == 1) return momentsOf(cloud, begin);
    const std::size_t middle = begin + (end - begin) / 2;
    return merged(ofRange(cloud, begin, middle), ofRange(cloud, middle, end));
  }

  static void storeNode(const GaussianMoments& moments, GaussianTree& tree, std::size_t node) {
    store(moments, tree.nodes, node);
    tree.radius_m[node] = static_cast<float>(moments.radius_m) * (1.0f + 1e-6f);
    tree.spread_m2[node] = static_cast<float>(moments.spread_m2);
    // That of points is infinite.
    constexpr double kMostGrowth_per_m2 = 1e12;
    tree.growth_per_m2[node] =
        static_cast<float>(std::min(moments.growth / moments.alone_m2, kMostGrowth_per_m2));
  }

  std::vector<Item>& items_;
  int levels_;
};

GaussianCloud inOrder(const GaussianCloud& cloud, const std::vector<Item>& items) {
  GaussianCloud to;
  to.degree = cloud.degree;
  to.preserves_light = cloud.preserves_light;
  const std::size_t n = items.size(), harmonics = cloud.harmonicsPerGaussian();
  to.position_m.resize(n);
  to.covariance_m2.resize(n);
  to.opacity.resize(n);
  to.color.resize(n);
  to.harmonics.resize(n * harmonics);
  parallelFor(n, [&](std::size_t i) {
    const std::size_t from = items[i].gaussian;
    to.position_m[i] = cloud.position_m[from];
    to.covariance_m2[i] = cloud.covariance_m2[from];
    to.opacity[i] = cloud.opacity[from];
    to.color[i] = cloud.color[from];
    std::copy_n(cloud.harmonics.begin() + static_cast<std::ptrdiff_t>(from * harmonics), harmonics,
                to.harmonics.begin() + static_cast<std::ptrdiff_t>(i * harmonics));
  });
  return to;
}

}  // namespace

GaussianCloud withTree(const GaussianCloud& cloud) {
  const std::size_t n = cloud.size();
  assert(n > 0 && n < std::size_t{1} << 31);
  std::vector<Item> items(n);
  parallelFor(n, [&](std::size_t i) {
    const Covariance3& v = cloud.covariance_m2[i];
    items[i] = {glm::vec4(cloud.position_m[i], std::sqrt(v.xx + v.yy + v.zz)),
                static_cast<std::uint32_t>(i)};
  });
  const auto tree = std::make_shared<GaussianTree>();
  tree->levels = static_cast<int>(std::bit_width(std::max<std::size_t>(n / kMinCluster, 1)));
  Builder builder(items, tree->levels);
  builder.sort();
  GaussianCloud sorted = inOrder(cloud, items);
  const std::size_t nodes = std::size_t{1} << tree->levels;
  tree->nodes.degree = cloud.degree;
  tree->nodes.preserves_light = cloud.preserves_light;
  tree->nodes.position_m.resize(nodes);
  tree->nodes.covariance_m2.resize(nodes);
  tree->nodes.opacity.resize(nodes);
  tree->nodes.color.resize(nodes);
  tree->nodes.harmonics.resize(nodes * cloud.harmonicsPerGaussian());
  tree->radius_m.resize(nodes);
  tree->spread_m2.resize(nodes);
  tree->growth_per_m2.resize(nodes);
  builder.merge(sorted, *tree);
  sorted.tree = tree;
  return sorted;
}

std::shared_ptr<const GaussianCloud> sharedWithTree(const GaussianCloud& cloud) {
  if (cloud.tree) return {std::shared_ptr<const GaussianCloud>(), &cloud};
  return std::make_shared<const GaussianCloud>(withTree(cloud));
}

}  // namespace foci
