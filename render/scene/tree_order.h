// The order of items in a perfect binary tree whose nodes are split at medians.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <utility>
#include <vector>

#include "base/parallel.h"

namespace foci {

/// Below it one task a subtree; fixed, so results are, too.
inline constexpr int kSerialLevels = 6;

/// The items [first, second) below the `j`-th node of a level, out of `n`. The root's level is 0; j
/// begins at 0.
inline std::pair<std::size_t, std::size_t> rangeBelow(std::uint64_t n, int level, std::size_t j) {
  return {n * j >> level, n * (j + 1) >> level};
}

/// An item while the tree is sorted.
template <typename Place>
struct TreeItem {
  Place place_m;
  std::uint32_t index;
};

/// Splits each node at the median along the longest extent of its items. The result does not depend
/// on the number of threads.
template <typename Place>
void sortIntoTree(std::vector<TreeItem<Place>>& items, int levels) {
  const auto sortBelow = [&](const auto& self, int level, std::size_t j, int last_level) -> void {
    if (level >= last_level) return;
    const auto [begin, end] = rangeBelow(items.size(), level, j);
    Place low(std::numeric_limits<float>::max()), high(std::numeric_limits<float>::lowest());
    for (std::size_t i = begin; i < end; ++i) {
      low = glm::min(low, items[i].place_m);
      high = glm::max(high, items[i].place_m);
    }
    const Place extent = high - low;
    int axis = 0;
    for (int k = 1; k < Place::length(); ++k) axis = extent[k] > extent[axis] ? k : axis;
    TreeItem<Place>* const all = items.data();
    std::nth_element(
        all + begin, all + rangeBelow(items.size(), level + 1, 2 * j).second, all + end,
        [axis](const auto& a, const auto& b) { return a.place_m[axis] < b.place_m[axis]; });
    self(self, level + 1, 2 * j, last_level);
    self(self, level + 1, 2 * j + 1, last_level);
  };
  const int serial = std::min(kSerialLevels, levels - 1);
  for (int level = 0; level < serial; ++level) {
    parallelFor(std::size_t{1} << level,
                [&](std::size_t j) { sortBelow(sortBelow, level, j, level + 1); });
  }
  parallelFor(std::size_t{1} << serial,
              [&](std::size_t j) { sortBelow(sortBelow, serial, j, levels - 1); });
}

}  // namespace foci
