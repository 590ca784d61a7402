// Points along a space-filling curve: what is near in space is near in memory. Private to the
// scene.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace foci {

/// Indices of the points along a Morton curve (21 bits an axis, over their bounding cube); points
/// in one cell stay in their order. The same at any number of threads. Fewer than 2^32 points, all
/// finite.
std::vector<std::uint32_t> mortonOrder(const std::vector<glm::vec3>& position_m);

/// `values[order[i]]` at i. An empty vector stays empty.
template <typename T>
void reorder(std::vector<T>& values, const std::vector<std::uint32_t>& order) {
  if (values.empty()) return;
  std::vector<T> sorted;
  sorted.reserve(values.size());
  for (const std::uint32_t i : order) sorted.push_back(values[i]);
  values.swap(sorted);
}

}  // namespace foci
