// The nearest neighbours of every point. Private to the scene's readers.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace foci {

inline constexpr std::size_t kMaxNeighbours = 64;

/// For point i the entries i * k to i * k + k - 1, not sorted; the point itself is not among them.
struct Neighbours {
  std::size_t k = 0;  ///< min(wanted, points - 1)
  std::vector<std::uint32_t> index;
  std::vector<float> reach_m;  ///< distance of the furthest of the k; empty for k = 0

  std::span<const std::uint32_t> of(std::size_t i) const { return {index.data() + i * k, k}; }
};

/// At most kMaxNeighbours wanted (asserted). Exact; the same at any number of threads. Fewer than
/// 2^32 points, all finite (asserted).
Neighbours findNeighbours(const std::vector<glm::vec3>& position_m, std::size_t wanted);

/// For each center the points within its radius, at most `most` of them, in an order that is the
/// same at any number of threads. All finite.
std::vector<std::vector<std::uint32_t>> findWithin(const std::vector<glm::vec3>& position_m,
                                                   const std::vector<glm::vec3>& centers_m,
                                                   const std::vector<float>& radius_m,
                                                   std::size_t most);

}  // namespace foci
