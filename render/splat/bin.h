// Which splats touch which tile, front to back.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "render/splat/splat.h"

namespace foci {

/// Lists of splat indices by tile, each in order of `near_m` (ties and distances equal to about one
/// part in 10^5: in order of surfel). The order does not depend on the number of threads.
class TileLists {
 public:
  void build(const SplatChunks& chunks, const glm::ivec2& size_px);

  glm::ivec2 tiles() const { return tiles_; }
  std::span<const std::uint32_t> tile(int index) const {
    return {entries_.data() + begin_[index], entries_.data() + begin_[index + 1]};
  }

 private:
  void sortByDistance(const SplatChunks& chunks);

  glm::ivec2 tiles_{0};
  std::vector<std::uint64_t> sorted_, scratch_;  // key << 32 | splat
  std::vector<std::size_t> begin_;
  std::vector<std::size_t> cursor_;
  std::vector<std::uint32_t> entries_;
};

}  // namespace foci
