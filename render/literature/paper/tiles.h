// Bins the paper's splats: which splats touch which tile.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "render/literature/paper/splat.h"

namespace foci {

/// Lists of splat indices by tile, each in the order of the chunks, at any number of threads. They
/// need no order of depth: an A-buffer takes its fragments in any order.
class PaperTileLists {
 public:
  void build(const PaperSplats& splats, const glm::ivec2& size_px);

  glm::ivec2 tiles() const { return tiles_; }
  std::span<const std::uint32_t> tile(std::size_t index) const {
    return {entries_.data() + begin_[index], entries_.data() + begin_[index + 1]};
  }

 private:
  glm::ivec2 tiles_{0};
  std::vector<std::size_t> begin_;
  std::vector<std::size_t> cursor_;
  std::vector<std::uint32_t> entries_;
};

}  // namespace foci
