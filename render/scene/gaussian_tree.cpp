#include "render/scene/gaussian_tree.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <type_traits>

#include "base/parallel.h"
#include "render/scene/gaussian_merge.h"
#include "render/scene/tree_order.h"

namespace foci {
namespace {

constexpr std::size_t kMinCluster = 4;

/// A position and a standard deviation.
using Item = TreeItem<glm::vec4>;

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
    const auto [begin, end] = rangeBelow(cloud_.size(), level, j);
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

/// Entry i of each array is entry `items[i].index` from then on. One array after the other, to
/// save memory.
void bringIntoOrder(GaussianCloud& cloud, const std::vector<Item>& items) {
  const auto gather = [&](auto& values, std::size_t each) {
    if (each == 0) return;
    std::remove_reference_t<decltype(values)> sorted(values.size());
    parallelFor(items.size(), [&](std::size_t i) {
      const auto from =
          values.begin() + static_cast<std::ptrdiff_t>(std::size_t{items[i].index} * each);
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
  if (cloud.tree) return cloud;
  const std::size_t n = cloud.size();
  assert(n > 0 && n < std::size_t{1} << 31);
  const auto tree = std::make_shared<GaussianTree>();
  tree->levels = gaussianTreeLevels(n);
  {
    std::vector<Item> items(n);
    parallelFor(n, [&](std::size_t i) {
      items[i] = {glm::vec4(cloud.position_m[i], std::sqrt(traceOf(cloud.covariance_m2[i]))),
                  static_cast<std::uint32_t>(i)};
    });
    sortIntoTree(items, tree->levels);
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
