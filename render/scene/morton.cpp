#include "render/scene/morton.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "base/parallel.h"
#include "base/parallel_sort.h"

namespace foci {
namespace {

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
