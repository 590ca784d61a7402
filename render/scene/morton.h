// Orders points along a space-filling curve, so that neighbours in space are near in memory.
// Private to the scene.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace foci {

/// Indices of the points along a Morton curve with 21 bits for each axis of their bounding cube.
/// Points in one cell keep their order. The result does not depend on the number of threads. Fewer
/// than 2^32 points, all finite.
std::vector<std::uint32_t> mortonOrder(std::span<const glm::vec3> position_m);

/// Moves `values[order[i]]` to i. An empty vector stays empty.
template <typename T>
void reorder(std::vector<T>& values, const std::vector<std::uint32_t>& order) {
  if (values.empty()) return;
  std::vector<T> sorted;
  sorted.reserve(values.size());
  for (const std::uint32_t i : order) sorted.push_back(values[i]);
  values.swap(sorted);
}

}  // namespace foci
