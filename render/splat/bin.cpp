#include "render/splat/bin.h"

#include <bit>
#include <cstring>
#include <utility>

#include "base/parallel.h"
#include "render/splat/constants.h"

namespace foci {
namespace {

/// Digits of up to 9 bits: the counters then fit into the first-level cache.
constexpr int kDigitBits = 9;
constexpr std::size_t kDigits = std::size_t{1} << kDigitBits;

/// Shorter lists are sorted by comparison.
constexpr std::size_t kFew = 64;

/// One stable counting pass of `from` into `to` by the digit at `shift`.
template <typename To>
void sortPass(std::span<const std::uint64_t> from, int shift, const To& to) {
  std::array<std::uint32_t, kDigits> offsets{};
  const auto digitOf = [shift](std::uint64_t pair) { return (pair >> shift) & (kDigits - 1); };
  for (const std::uint64_t pair : from) ++offsets[digitOf(pair)];
  std::uint32_t running = 0;
  for (std::uint32_t& offset : offsets) running += std::exchange(offset, running);
  for (const std::uint64_t pair : from) to(offsets[digitOf(pair)]++, pair);
}

/// Sorts a tile's splats by key. Equal keys keep their order, which is by splat.
/// @param scratch  memory, kept for the next call
void sortByKey(std::span<std::uint64_t> pairs, std::uint32_t* splats,
               std::vector<std::uint64_t>& scratch) {
  if (pairs.size() < kFew) {
    std::sort(pairs.begin(), pairs.end());
    std::transform(pairs.begin(), pairs.end(), splats,
                   [](std::uint64_t pair) { return static_cast<std::uint32_t>(pair); });
    return;
  }
  scratch.resize(pairs.size());
  sortPass(pairs, 32, [&](std::uint32_t at, std::uint64_t pair) { scratch[at] = pair; });
  sortPass(scratch, 32 + kDigitBits, [&](std::uint32_t at, std::uint64_t pair) {
    splats[at] = static_cast<std::uint32_t>(pair);
  });
}

using Taps = std::array<float, 4>;

/// The channels of a pixel: one vector of the processor.
using Channels [[gnu::vector_size(4 * sizeof(float))]] = float;

Channels channelsOf(const glm::vec4& value) {
  Channels channels;
  std::memcpy(&channels, &value, sizeof channels);
  return channels;
}

/// A pixel's place among the samples: the first of four samples, and their taps.
struct Place {
  int first;
  Taps taps;
};

std::array<Place, kTile * kMaxStep_px> placesOf(const Tile& tile) {
  std::array<Place, kTile * kMaxStep_px> places{};
  for (int i = 0; i < tile.side_px; ++i) {
    const float at =
        (static_cast<float>(i) + 0.5f) / static_cast<float>(tile.step_px) - 0.5f + kApron;
    const int below = static_cast<int>(at);
    places[i] = {below - 1, catmullRom(at - static_cast<float>(below))};
  }
  return places;
}

}  // namespace

int stepFor(float sigma_px) {
  int step_px = kMaxStep_px;
  while (step_px > 1 && !(sigma_px >= kSigmasAStep * static_cast<float>(step_px))) step_px /= 2;
  return step_px;
}

std::vector<TileLists::Blur> TileLists::blurOfCells(const SplatChunks& chunks) const {
  // A pixel is interpolated from samples up to one and a half steps away. A splat that needs finer
  // samples affects pixels that far.
  constexpr auto reachOf = [](int step_px) { return 3 * step_px / 2; };
  constexpr int kMaxReach_px = reachOf(kMaxStep_px);
  const std::size_t cell_count = static_cast<std::size_t>(cells_.x) * cells_.y;
  const std::size_t chunk_count = chunks.count.size();
  std::vector<Blur> all(std::max<std::size_t>(chunk_count, 1) * cell_count);
  parallelFor(chunk_count, [&](std::size_t c) {
    Blur* cells = all.data() + c * cell_count;
    for (std::uint32_t i = 0; i < chunks.count[c]; ++i) {
      const SplatKey& key = chunks.keys[c * chunks.chunk_size + i];
      const int own_px = stepFor(key.sigma_px);
      const auto stepIn = [&](int x, int y) {
        const int below_px = std::max(y * kTile - key.y1, key.y0 - (y + 1) * kTile + 1);
        const int beside_px = std::max(x * kTile - key.x1, key.x0 - (x + 1) * kTile + 1);
        const int apart_px = std::max(below_px, beside_px);
        int step_px = own_px;
        while (step_px < kMaxStep_px && apart_px > reachOf(2 * step_px)) step_px *= 2;
        return step_px;
      };
      const int x0 = std::max(key.x0 - kMaxReach_px, 0) / kTile;
      const int y0 = std::max(key.y0 - kMaxReach_px, 0) / kTile;
      const int x1 = std::min(key.x1 + kMaxReach_px, size_px_.x - 1) / kTile;
      const int y1 = std::min(key.y1 + kMaxReach_px, size_px_.y - 1) / kTile;
      for (int y = y0; y <= y1; ++y) {
        for (int x = x0; x <= x1; ++x) {
          Blur& cell = cells[static_cast<std::size_t>(y) * cells_.x + x];
          // Skip the search for a cell that is already as fine.
          cell.add({cell.step_px > own_px ? stepIn(x, y) : own_px, key.blur_px});
        }
      }
    }
  });
  for (std::size_t c = 1; c < chunk_count; ++c) {
    for (std::size_t i = 0; i < cell_count; ++i) all[i].add(all[c * cell_count + i]);
  }
  all.resize(cell_count);
  return all;
}

void TileLists::chooseTiles(const SplatChunks& chunks, bool coarse) {
  cells_ = (size_px_ + kTile - 1) / kTile;
  tile_of_cell_.assign(static_cast<std::size_t>(cells_.x) * cells_.y, 0);
  tiles_.clear();
  // If nothing is blurred and all tiles are fine, the cells' blur is not used.
  const bool matters = coarse || chunks.lens;
  const std::vector<Blur> cells =
      matters ? blurOfCells(chunks) : std::vector<Blur>(tile_of_cell_.size());

  // Divide the largest squares until one tile has few enough samples.
  const auto blurOf = [&](int x0, int y0, int side) {
    Blur sum{.step_px = coarse ? kMaxStep_px : 1};
    for (int y = y0; y < std::min(y0 + side, cells_.y); ++y) {
      for (int x = x0; x < std::min(x0 + side, cells_.x); ++x) {
        sum.add(cells[static_cast<std::size_t>(y) * cells_.x + x]);
      }
    }
    return sum;
  };
  const auto divide = [&](auto&& self, int x0, int y0, int side) -> void {
    if (x0 >= cells_.x || y0 >= cells_.y) return;
    const Blur blur = blurOf(x0, y0, side);
    if (blur.step_px < side) {
      const int half = side / 2;
      self(self, x0, y0, half);
      self(self, x0 + half, y0, half);
      self(self, x0, y0 + half, half);
      self(self, x0 + half, y0 + half, half);
      return;
    }
    for (int y = y0; y < std::min(y0 + side, cells_.y); ++y) {
      for (int x = x0; x < std::min(x0 + side, cells_.x); ++x) {
        tile_of_cell_[static_cast<std::size_t>(y) * cells_.x + x] =
            static_cast<std::uint32_t>(tiles_.size());
      }
    }
    tiles_.push_back({x0 * kTile, y0 * kTile, side * kTile, blur.step_px, blur.radius_px});
  };
  // No tile is much larger than the image: the squares of `SpotCheck` are one cell.
  const auto longest = static_cast<unsigned>(std::max(cells_.x, cells_.y));
  const int largest = std::min(kMaxStep_px, static_cast<int>(std::bit_ceil(longest)));
  for (int y = 0; y < cells_.y; y += largest) {
    for (int x = 0; x < cells_.x; x += largest) divide(divide, x, y, largest);
  }
  max_apron_px_ = 0;
  for (const Tile& tile : tiles_) {
    max_apron_px_ = std::max(max_apron_px_, tile.apron() * tile.step_px);
  }
  static_assert(kApron * kMaxStep_px <= kTile);
  near_apron_px_.assign(tile_of_cell_.size(), 0);
  for (const Tile& tile : tiles_) {
    if (tile.step_px == 1) continue;
    const auto apron_px = static_cast<std::uint8_t>(tile.apron() * tile.step_px);
    const glm::ivec2 first = glm::max(glm::ivec2(tile.x_px, tile.y_px) / kTile - 1, 0);
    const glm::ivec2 end =
        glm::min((glm::ivec2(tile.x_px, tile.y_px) + tile.side_px) / kTile + 1, cells_);
    for (int y = first.y; y < end.y; ++y) {
      for (int x = first.x; x < end.x; ++x) {
        std::uint8_t& near = near_apron_px_[static_cast<std::size_t>(y) * cells_.x + x];
        near = std::max(near, apron_px);
      }
    }
  }
}

/// Counts the splats of each tile, fills the lists by chunks in order of surfel, then sorts each
/// list. `forEachTile(key, begin, visit)` calls begin(n) with an upper bound n of the splat's
/// tiles, then visit(tile, counts) for each; a tile with `counts` false is not touched.
template <typename ForEachTile>
void TileLists::fill(const SplatChunks& chunks, const ForEachTile& forEachTile) {
  const std::size_t tile_count = tiles_.size(), chunk_count = chunks.count.size();
  cursor_.assign(chunk_count * tile_count, 0);
  touched_.resize(std::max(touched_.size(), chunk_count));
  std::vector<std::array<std::uint32_t, 2>> range(chunk_count);
  parallelFor(chunk_count, [&](std::size_t c) {
    std::size_t* count = cursor_.data() + c * tile_count;
    Touched& touched = touched_[c];
    touched.clear();
    std::uint32_t lowest = UINT32_MAX, highest = 0;
    for (std::uint32_t i = 0; i < chunks.count[c]; ++i) {
      const SplatKey& key = chunks.keys[c * chunks.chunk_size + i];
      const auto bits = std::bit_cast<std::uint32_t>(key.distance_m);
      lowest = std::min(lowest, bits);
      highest = std::max(highest, bits);
      forEachTile(
          key, [&](std::size_t max_tiles) { touched.begin(max_tiles); },
          [&](std::uint32_t tile, bool counts) {
            count[tile] += counts;
            touched.add(tile, counts);
          });
      touched.end();
    }
    range[c] = {lowest, highest};
  });
  // A key is the distance's bits, which order like the distance, less the smallest, and truncated.
  std::uint32_t lowest = UINT32_MAX, highest = 0;
  for (const auto& [low, high] : range) {
    lowest = std::min(lowest, low);
    highest = std::max(highest, high);
  }
  const int key_bits = highest >= lowest ? static_cast<int>(std::bit_width(highest - lowest)) : 0;
  const int shift = std::max(0, key_bits - kKeyBits);

  begin_.resize(tile_count + 1);
  std::size_t running = 0;
  for (std::size_t tile = 0; tile < tile_count; ++tile) {
    begin_[tile] = running;
    for (std::size_t c = 0; c < chunk_count; ++c) {
      running += std::exchange(cursor_[c * tile_count + tile], running);
    }
  }
  begin_[tile_count] = running;
  pairs_.resize(running);
  parallelFor(chunk_count, [&](std::size_t c) {
    std::size_t* cursor = cursor_.data() + c * tile_count;
    const std::uint32_t* tiles = touched_[c].data();
    for (std::uint32_t i = 0; i < chunks.count[c]; ++i) {
      const std::size_t splat = c * chunks.chunk_size + i;
      const float distance_m = chunks.keys[splat].distance_m;
      const std::uint64_t bits = (std::bit_cast<std::uint32_t>(distance_m) - lowest) >> shift;
      const std::uint32_t* const end = tiles + 1 + *tiles;
      for (++tiles; tiles < end; ++tiles) pairs_[cursor[*tiles]++] = bits << 32 | splat;
    }
  });
  entries_.resize(running);
  parallelFor(tile_count, [&](std::size_t tile) {
    thread_local std::vector<std::uint64_t> scratch;
    sortByKey({pairs_.data() + begin_[tile], pairs_.data() + begin_[tile + 1]},
              entries_.data() + begin_[tile], scratch);
  });
}

void TileLists::build(const SplatChunks& chunks, const glm::ivec2& size_px, bool coarse) {
  size_px_ = size_px;
  chooseTiles(chunks, coarse);
  fill(chunks, [&](const SplatKey& key, auto&& begin, auto&& visit) {
    int x0 = key.x0 / kTile, x1 = key.x1 / kTile, y0 = key.y0 / kTile, y1 = key.y1 / kTile;
    int apron_px = max_apron_px_;
    if (x1 - x0 <= 1 && y1 - y0 <= 1) {
      // A tile whose apron reaches the splat has a cell next to one of the splat's, since no apron
      // is wider than a cell.
      apron_px = max_apron_px_ == 0 ? 0
                                    : std::max({nearApron_px(x0, y0), nearApron_px(x1, y0),
                                                nearApron_px(x0, y1), nearApron_px(x1, y1)});
      // At most two by two cells, far from coarse tiles, take four visits without a branch.
      if (apron_px == 0) {
        const bool wide = x1 > x0, high = y1 > y0;
        begin(4);
        visit(tileAt(x0, y0), true);
        visit(tileAt(x1, y0), wide);
        visit(tileAt(x0, y1), high);
        visit(tileAt(x1, y1), wide && high);
        return;
      }
    }

    // Other splats visit each tile at the first of its cells.
    x0 = std::max(key.x0 - apron_px, 0) / kTile;
    y0 = std::max(key.y0 - apron_px, 0) / kTile;
    x1 = std::min(key.x1 + apron_px, size_px_.x - 1) / kTile;
    y1 = std::min(key.y1 + apron_px, size_px_.y - 1) / kTile;
    begin(static_cast<std::size_t>(x1 - x0 + 1) * (y1 - y0 + 1));
    for (int y = y0; y <= y1; ++y) {
      for (int x = x0; x <= x1;) {
        const std::uint32_t index = tileAt(x, y);
        const Tile& tile = tiles_[index];
        if (y == std::max(tile.y_px / kTile, y0)) {
          const int reach_px = tile.apron() * tile.step_px;
          visit(index,
                key.x1 >= tile.x_px - reach_px && key.x0 < tile.x_px + tile.side_px + reach_px &&
                    key.y1 >= tile.y_px - reach_px && key.y0 < tile.y_px + tile.side_px + reach_px);
        }
        x = (tile.x_px + tile.side_px) / kTile;
      }
    }
  });
}

void interpolateTile(const Tile& tile, const glm::vec4* rgba, const float* depth_m, float weight,
                     Frame& frame) {
  const int width = std::min(tile.side_px, frame.size_px.x - tile.x_px);
  const int height = std::min(tile.side_px, frame.size_px.y - tile.y_px);
  const int samples = tile.samplesWithApron();
  // Takes a pixel, and its depth times coverage.
  const auto put = [&](std::size_t pixel, glm::vec4 value, float weighted_m) {
    glm::vec4& to = frame.rgba[pixel];
    if (depth_m) {
      float& far_m = frame.depth_m[pixel];
      if (weight < 1.0f) weighted_m = glm::mix(far_m * to.a, weighted_m, weight);
      const float coverage = weight < 1.0f ? glm::mix(to.a, value.a, weight) : value.a;
      far_m = coverage > 0.0f ? std::max(weighted_m / coverage, 0.0f) : 0.0f;
    }
    to = weight < 1.0f ? glm::mix(to, value, weight) : value;
  };
  const auto rowOf = [&](int y) {
    return static_cast<std::size_t>(tile.y_px + y) * frame.size_px.x + tile.x_px;
  };
  if (tile.step_px == 1) {
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const int from = y * samples + x;
        put(rowOf(y) + x, rgba[from], depth_m ? depth_m[from] : 0.0f);
      }
    }
    return;
  }

  const auto places = placesOf(tile);
  std::array<Channels, kMostSamples> row;
  std::array<float, kMostSamples> depth_row{};
  const auto mix = [](const Taps& taps, const auto& sample) {
    return taps[0] * sample(0) + taps[1] * sample(1) + taps[2] * sample(2) + taps[3] * sample(3);
  };
  for (int y = 0; y < height; ++y) {
    const Place& down = places[y];
    for (int x = 0; x < samples; ++x) {
      const int first = down.first * samples + x;
      row[x] = mix(down.taps, [&](int k) { return channelsOf(rgba[first + k * samples]); });
      if (!depth_m) continue;
      depth_row[x] = mix(down.taps, [&](int k) { return depth_m[first + k * samples]; });
    }
    for (int x = 0; x < width; ++x) {
      const Place& across = places[x];
      const Channels value = mix(across.taps, [&](int k) { return row[across.first + k]; });
      float far_m = 0.0f;
      if (depth_m) far_m = mix(across.taps, [&](int k) { return depth_row[across.first + k]; });
      put(rowOf(y) + x, {value[0], value[1], value[2], std::clamp(value[3], 0.0f, 1.0f)}, far_m);
    }
  }
}

}  // namespace foci
