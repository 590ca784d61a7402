#include "render/splat/bin.h"

#include "app/base/parallel.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

namespace foci {
namespace {

constexpr int kDigitBits = 9;
constexpr std::size_t kDigits = std::size_t{1} << kDigitBits;
constexpr int kKeyBits = 2 * kDigitBits;
constexpr std::size_t kSlices =
    32;  // of the sorted list; fixed, so that no result hangs on the threads

struct Slice {
  std::size_t begin, end;
};

Slice sliceOf(std::size_t slice, std::size_t n) {
  return {slice * n / kSlices, (slice + 1) * n / kSlices};
}

/// One stable counting pass of `from` into `to` by the digit at `shift`.
void sortPass(const std::vector<std::uint64_t>& from, std::vector<std::uint64_t>& to, int shift) {
  std::vector<std::array<std::uint32_t, kDigits>> offsets(kSlices);
  const auto digitOf = [shift](std::uint64_t pair) { return (pair >> shift) & (kDigits - 1); };
  parallelFor(kSlices, [&](std::size_t s) {
    offsets[s].fill(0);
    const auto [begin, end] = sliceOf(s, from.size());
    for (std::size_t i = begin; i < end; ++i) ++offsets[s][digitOf(from[i])];
  });
  std::uint32_t running = 0;
  for (std::size_t digit = 0; digit < kDigits; ++digit) {
    for (std::size_t s = 0; s < kSlices; ++s) {
      running += std::exchange(offsets[s][digit], running);
    }
  }
  parallelFor(kSlices, [&](std::size_t s) {
    const auto [begin, end] = sliceOf(s, from.size());
    for (std::size_t i = begin; i < end; ++i) to[offsets[s][digitOf(from[i])]++] = from[i];
  });
}

}  // namespace

void TileLists::sortByDistance(const SplatChunks& chunks) {
  // Keys are the bits of the distance, which order like the distance, less the least and cut to 22
  // bits.
  const std::size_t n = chunks.total();
  std::vector<std::size_t> first(chunks.count.size() + 1, 0);
  for (std::size_t c = 0; c < chunks.count.size(); ++c) first[c + 1] = first[c] + chunks.count[c];
  std::vector<std::array<std::uint32_t, 2>> range(chunks.count.size());
  scratch_.resize(n);
  sorted_.resize(n);
  parallelFor(chunks.count.size(), [&](std::size_t c) {
    std::uint32_t least = UINT32_MAX, most = 0;
    for (std::uint32_t i = 0; i < chunks.count[c]; ++i) {
      const std::size_t splat = c * chunks.chunk_size + i;
      const auto bits = std::bit_cast<std::uint32_t>(chunks.keys[splat].near_m);
      least = std::min(least, bits);
      most = std::max(most, bits);
      sorted_[first[c] + i] = std::uint64_t{bits} << 32 | splat;
    }
    range[c] = {least, most};
  });
  std::uint32_t least = UINT32_MAX, most = 0;
  for (const auto& [low, high] : range) {
    least = std::min(least, low);
    most = std::max(most, high);
  }
  const int key_bits = n > 0 ? static_cast<int>(std::bit_width(most - least)) : 0;
  const int shift = std::max(0, key_bits - kKeyBits);
  parallelFor(kSlices, [&](std::size_t s) {
    const auto [begin, end] = sliceOf(s, n);
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint64_t key = ((sorted_[i] >> 32) - least) >> shift;
      sorted_[i] = key << 32 | (sorted_[i] & UINT32_MAX);
    }
  });
  sortPass(sorted_, scratch_, 32);
  sortPass(scratch_, sorted_, 32 + kDigitBits);
}

void TileLists::build(const SplatChunks& chunks, const glm::ivec2& size_px) {
  sortByDistance(chunks);
  tiles_ = (size_px + kTile_px - 1) / kTile_px;
  const std::size_t tile_count = static_cast<std::size_t>(tiles_.x) * tiles_.y;

  // Count, sum up and fill by slices of the sorted list, so that every tile's list keeps its order.
  const auto forEachTile = [&](std::size_t slice, auto&& visit) {
    const auto [begin, end] = sliceOf(slice, sorted_.size());
    for (std::size_t i = begin; i < end; ++i) {
      const auto splat = static_cast<std::uint32_t>(sorted_[i]);
      const SplatKey key = chunks.keys[splat];
      const bool wide = key.x1 > key.x0, high = key.y1 > key.y0;
      if (key.x1 - key.x0 < 2 && key.y1 - key.y0 < 2) {
        // Most splats: four visits without a branch, of which some do not count.
        const std::size_t corner = static_cast<std::size_t>(key.y0) * tiles_.x + key.x0;
        const std::size_t below = corner + (high ? tiles_.x : 0);
        visit(corner, splat, true);
        visit(corner + wide, splat, wide);
        visit(below, splat, high);
        visit(below + wide, splat, wide && high);
        continue;
      }
      for (unsigned y = key.y0; y <= key.y1; ++y) {
        for (unsigned x = key.x0; x <= key.x1; ++x) {
          visit(static_cast<std::size_t>(y) * tiles_.x + x, splat, true);
        }
      }
    }
  };
  cursor_.assign(kSlices * tile_count, 0);
  parallelFor(kSlices, [&](std::size_t s) {
    std::size_t* count = cursor_.data() + s * tile_count;
    forEachTile(s, [&](std::size_t tile, std::uint32_t, bool counts) { count[tile] += counts; });
  });
  begin_.resize(tile_count + 1);
  std::size_t running = 0;
  for (std::size_t tile = 0; tile < tile_count; ++tile) {
    begin_[tile] = running;
    for (std::size_t s = 0; s < kSlices; ++s) {
      running += std::exchange(cursor_[s * tile_count + tile], running);
    }
  }
  begin_[tile_count] = running;
  entries_.resize(running);
  parallelFor(kSlices, [&](std::size_t s) {
    std::size_t* cursor = cursor_.data() + s * tile_count;
    std::uint32_t nowhere = 0;
    forEachTile(s, [&](std::size_t tile, std::uint32_t splat, bool counts) {
      std::uint32_t* entry = entries_.data() + cursor[tile];
      *(counts ? entry : &nowhere) = splat;
      cursor[tile] += counts;
    });
  });
}

}  // namespace foci
