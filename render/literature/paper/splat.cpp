#include "render/literature/paper/splat.h"

#include <utility>

#include "base/parallel.h"

namespace foci {
namespace {

/// The chunks are binned in this many slices. Fixed, so that no result depends on the number of
/// threads; chosen by hand, above the number of threads of most machines.
constexpr std::size_t kBinSlices = 32;

}  // namespace

void PaperTileLists::build(const PaperSplats& splats, const glm::ivec2& size_px) {
  tiles_ = (size_px + kPaperTile_px - 1) / kPaperTile_px;
  const std::size_t tile_count = static_cast<std::size_t>(tiles_.x) * tiles_.y;

  // Count, sum up, and fill slice by slice, so that each tile's list keeps the order of the chunks.
  const auto forEachTile = [&](std::size_t slice, auto&& visit) {
    const std::size_t chunks = splats.chunks.size();
    for (std::size_t c = slice * chunks / kBinSlices; c < (slice + 1) * chunks / kBinSlices; ++c) {
      const std::size_t end = splats.chunks[c].begin + splats.chunks[c].count;
      for (std::size_t i = splats.chunks[c].begin; i < end; ++i) {
        const PaperSplatTiles at = splats.tiles[i];
        for (unsigned y = at.y0; y <= at.y1; ++y) {
          for (unsigned x = at.x0; x <= at.x1; ++x) {
            visit(static_cast<std::size_t>(y) * tiles_.x + x, static_cast<std::uint32_t>(i));
          }
        }
      }
    }
  };
  cursor_.assign(kBinSlices * tile_count, 0);
  parallelFor(kBinSlices, [&](std::size_t s) {
    std::size_t* count = cursor_.data() + s * tile_count;
    forEachTile(s, [&](std::size_t tile, std::uint32_t) { ++count[tile]; });
  });
  begin_.resize(tile_count + 1);
  std::size_t running = 0;
  for (std::size_t tile = 0; tile < tile_count; ++tile) {
    begin_[tile] = running;
    for (std::size_t s = 0; s < kBinSlices; ++s) {
      running += std::exchange(cursor_[s * tile_count + tile], running);
    }
  }
  begin_[tile_count] = running;
  entries_.resize(running);
  parallelFor(kBinSlices, [&](std::size_t s) {
    std::size_t* cursor = cursor_.data() + s * tile_count;
    forEachTile(s,
                [&](std::size_t tile, std::uint32_t splat) { entries_[cursor[tile]++] = splat; });
  });
}

}  // namespace foci
