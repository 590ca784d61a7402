// Which points are near: the nearest neighbours of every point, and an order along a space-filling
// curve, so that neighbours in space are near in memory. Private to the scene.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace foci {

inline constexpr std::size_t kMaxNeighbours = 64;

/// The neighbours of point i are the entries i * k to i * k + k - 1, the nearest first. The point
/// itself is not among them.
struct Neighbours {
  std::size_t k = 0;  ///< min(wanted, points - 1)
  std::vector<std::uint32_t> index;
  std::vector<float> reach_m;  ///< distance of the k-th neighbour; empty if k = 0

  std::span<const std::uint32_t> of(std::size_t i) const { return {index.data() + i * k, k}; }
};

/// Finds the `wanted` nearest neighbours of each point, at most kMaxNeighbours (asserted). Exact;
/// the result does not depend on the number of threads. Fewer than 2^32 points (asserted), all
/// finite.
Neighbours findNeighbours(std::span<const glm::vec3> position_m, std::size_t wanted);

/// The same, but a point's neighbours are of its own group.
/// @param group  by point, or empty: one group; a group of up to `wanted` points joins the next one
Neighbours findNeighbours(std::span<const glm::vec3> position_m,
                          std::span<const std::uint32_t> group, std::size_t wanted);

/// Finds the points within each center's radius, at most `max_points` of them. Their order does not
/// depend on the number of threads. All points finite.
std::vector<std::vector<std::uint32_t>> findWithin(std::span<const glm::vec3> position_m,
                                                   std::span<const glm::vec3> centers_m,
                                                   std::span<const float> radius_m,
                                                   std::size_t max_points);

/// Indices of the points along a Morton curve with 21 bits for each axis of their bounding cube.
/// Points in one cell keep their order. The result does not depend on the number of threads. Fewer
/// than 2^32 points, all finite.
std::vector<std::uint32_t> mortonOrder(std::span<const glm::vec3> position_m);

/// `values[order[i]]` at i. An empty vector stays empty.
template <class Values>
auto picked(const Values& values, std::span<const std::uint32_t> order) {
  std::vector<typename Values::value_type> result;
  if (values.empty()) return result;
  result.reserve(order.size());
  for (const std::uint32_t i : order) result.push_back(values[i]);
  return result;
}

/// Moves `values[order[i]]` to i.
template <typename T>
void reorder(std::vector<T>& values, const std::vector<std::uint32_t>& order) {
  values = picked(values, order);
}

}  // namespace foci
