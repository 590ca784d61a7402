#include "render/scene/gaussian_tree.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

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

/// Sorts the items below a node.
void sortBelow(std::vector<Item>& items, int level, std::size_t j, int last_level) {
  if (level >= last_level) return;
  const auto [begin, end] = gaussiansBelow(items.size(), level, j);
  const std::size_t middle = gaussiansBelow(items.size(), level + 1, 2 * j).second;
  partition(items.data(), begin, middle, end);
  sortBelow(items, level + 1, 2 * j, last_level);
  sortBelow(items, level + 1, 2 * j + 1, last_level);
}

void sortItems(std::vector<Item>& items, int levels) {
  const int serial = std::min(kSerialLevels, levels - 1);
  for (int level = 0; level < serial; ++level) {
    parallelFor(std::size_t{1} << level,
                [&](std::size_t j) { sortBelow(items, level, j, level + 1); });
  }
  parallelFor(std::size_t{1} << serial,
              [&](std::size_t j) { sortBelow(items, serial, j, levels - 1); });
}

/// Makes the nodes of a tree whose levels and sizes are set.
class Merger {
 public:
  /// @param cloud  in the tree's order
  Merger(const GaussianCloud& cloud, GaussianTree& tree) : cloud_(cloud), tree_(tree) {}

  void merge() {
    const int serial = std::min(kSerialLevels, tree_.levels - 1);
    std::vector<GaussianMoments> moments(std::size_t{1} << serial);
    parallelFor(moments.size(), [&](std::size_t j) { moments[j] = below(serial, j); });
    for (int level = serial - 1; level >= 0; --level) {
      for (std::size_t j = 0; j < std::size_t{1} << level; ++j) {
        moments[j] = merged(moments[2 * j], moments[2 * j + 1]);
        storeNode(moments[j], (std::size_t{1} << level) + j);
      }
    }
  }

 private:
  /// Makes the nodes of a subtree.
  GaussianMoments below(int level, std::size_t j) {
    const auto [begin, end] = gaussiansBelow(cloud_.size(), level, j);
    const GaussianMoments moments =
        level + 1 == tree_.levels ? ofRange(begin, end)
                                  : merged(below(level + 1, 2 * j), below(level + 1, 2 * j + 1));
    storeNode(moments, (std::size_t{1} << level) + j);
    return moments;
  }

  GaussianMoments ofRange(std::size_t begin, std::size_t end) const {
    if (end - begin == 1) return momentsOf(cloud_, begin);
    const std::size_t middle = begin + (end - begin) / 2;
    return merged(ofRange(begin, middle), ofRange(middle, end));
  }

  void storeNode(const GaussianMoments& moments, std::size_t node) {
    store(moments, tree_.nodes, node);
    tree_.radius_m[node] = static_cast<float>(moments.radius_m) * (1.0f + 1e-6f);
    tree_.spread_m2[node] = static_cast<float>(moments.spread_m2);
    // That of points is infinite.
    constexpr double kMostGrowth_per_m2 = 1e12;
    tree_.growth_per_m2[node] =
        static_cast<float>(std::min(moments.growth / moments.alone_m2, kMostGrowth_per_m2));
  }

  const GaussianCloud& cloud_;
  GaussianTree& tree_;
};

/// Entry i of each array is entry `items[i].gaussian` from then on. One array after the other, to
/// save memory.
void bringIntoOrder(GaussianCloud& cloud, const std::vector<Item>& items) {
  const auto gather = [&](auto& values, std::size_t each) {
    if (each == 0) return;
    std::remove_reference_t<decltype(values)> sorted(values.size());
    parallelFor(items.size(), [&](std::size_t i) {
      const auto from =
          values.begin() + static_cast<std::ptrdiff_t>(std::size_t{items[i].gaussian} * each);
      std::copy_n(from, each, sorted.begin() + static_cast<std::ptrdiff_t>(i * each));
    });
    values = std::move(sorted);
  };
  gather(cloud.position_m, 1);
  gather(cloud.covariance_m2, 1);
  gather(cloud.opacity, 1);
  gather(cloud.color, 1);
  gather(cloud.harmonics, cloud.harmonicsPerGaussian());
}

}  // namespace

int gaussianTreeLevels(std::size_t n) {
  return static_cast<int>(std::bit_width(std::max<std::size_t>(n / kMinCluster, 1)));
}

GaussianCloud withTree(GaussianCloud cloud) {
  const std::size_t n = cloud.size();
  assert(n > 0 && n < std::size_t{1} << 31);
  const auto tree = std::make_shared<GaussianTree>();
  tree->levels = gaussianTreeLevels(n);
  {
    std::vector<Item> items(n);
    parallelFor(n, [&](std::size_t i) {
      const Covariance3& v = cloud.covariance_m2[i];
      items[i] = {glm::vec4(cloud.position_m[i], std::sqrt(v.xx + v.yy + v.zz)),
                  static_cast<std::uint32_t>(i)};
    });
    sortItems(items, tree->levels);
    bringIntoOrder(cloud, items);
  }
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
  Merger(cloud, *tree).merge();
  cloud.tree = tree;
  return cloud;
}

std::shared_ptr<const GaussianCloud> sharedWithTree(const GaussianCloud& cloud) {
  if (cloud.tree) return {std::shared_ptr<const GaussianCloud>(), &cloud};
  return std::make_shared<const GaussianCloud>(withTree(cloud));
}

}  // namespace foci
