#include "render/methods/discs_of_tiles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace foci {
namespace {

/// Share of the frame that may be beyond the tolerance.
constexpr float kShareBeyond = 0.05f;

/// No sample's error is this many times the tolerance. Otherwise the few that may be beyond it
/// would show single views, and change as the eye moves.
constexpr float kMostOverTolerance = 1.5f;

/// The error of the mean of n views of an edge falls as n to this power (a fit from 3 to 91).
constexpr float kEdgeOrder = -0.77f;

/// A tile's next number of discs is chosen for this share of its limit, since errors vary.
constexpr float kAim = 0.9f;

/// Halvings of the range up to the largest error that is told from others.
constexpr int kHalvings = 12;
constexpr float kLargest_JND = 64.0f;
constexpr float kNoLimit = std::numeric_limits<float>::infinity();

/// The share of an error that the limit leaves.
float shareOf(float limit, float error) { return error > limit ? limit / error : 1.0f; }

/// The largest value up to which `tooLarge` is false, by bisection.
template <typename TooLarge>
float largestThat(const TooLarge& tooLarge) {
  float low = 0.0f, high = kLargest_JND;
  for (int i = 0; i < kHalvings; ++i) {
    const float middle = 0.5f * (low + high);
    (tooLarge(middle) ? high : low) = middle;
  }
  return low;
}

}  // namespace

void DiscsOfTiles::choose(std::span<const Tile> tiles, const glm::ivec2& size_px,
                          std::span<const TileBlur> blurs, std::span<const float> merging,
                          float tolerance) {
  tolerance_ = tolerance;
  area_px2_ = 0.0f;
  tiles_.assign(tiles.size(), {});
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    TileState& tile = tiles_[t];
    const glm::ivec2 seen_px =
        glm::min(glm::ivec2(tiles[t].side_px), size_px - glm::ivec2(tiles[t].x_px, tiles[t].y_px));
    tile.area_px2 = static_cast<float>(seen_px.x * seen_px.y);
    area_px2_ += tile.area_px2;
    tile.blur = blurs[t];
    tile.merging = merging[t];
    const auto enough = std::ranges::find_if(kDiscs, [&](const Discs& each) {
      return errorOf(each, tile.blur) + tile.merging <= tolerance;
    });
    tile.last = static_cast<std::size_t>(std::min(enough, kDiscs.end() - 1) - kDiscs.begin());
    tile.index = std::min<std::size_t>(tile.last, 1);
  }
}

std::size_t DiscsOfTiles::indexFor(const TileState& tile, float share) const {
  if (tile.index == tile.last || share >= 1.0f) return tile.index;
  const float views =
      static_cast<float>(kDiscs[tile.index].count) * std::pow(kAim * share, 1.0f / kEdgeOrder);
  std::size_t index = tile.index + 1;
  while (index < tile.last && static_cast<float>(kDiscs[index].count) < views) ++index;
  return index;
}

float DiscsOfTiles::areaBeyond_px2(float error, float limit) const {
  float sum_px2 = 0.0f;
  for (const TileState& tile : tiles_) {
    const float highest = error - tile.merging;
    const float scale = shareOf(limit, tile.typical);
    const std::size_t index = indexFor(tile, scale);
    if (index == 0 || (index > tile.index && index == tile.last)) {
      if (errorOf(kDiscs[index], tile.blur) > highest) sum_px2 += tile.area_px2;
      continue;
    }
    const auto beyond = std::ranges::count_if(tile.errors.all(),
                                              [&](float each) { return scale * each > highest; });
    sum_px2 += tile.area_px2 * static_cast<float>(beyond) / static_cast<float>(tile.errors.count);
  }
  return sum_px2;
}

bool DiscsOfTiles::refine(const std::vector<SampledErrors>& standard_errors) {
  for (std::size_t t = 0; t < tiles_.size(); ++t) {
    TileState& tile = tiles_[t];
    if (!std::exchange(tile.is_next, false) || tile.index == 0) continue;
    const Discs& discs = kDiscs[tile.index];
    const float bound = errorOf(discs, tile.blur);
    tile.errors = standard_errors[t];
    float squares = 0.0f;
    for (float& each : std::span(tile.errors.jnd).first(tile.errors.count)) {
      each = std::min(discs.error_share * each, bound);
      squares += each * each;
    }
    tile.most = std::ranges::max(tile.errors.all());
    tile.typical = std::sqrt(squares / static_cast<float>(tile.errors.count));
  }
  const float allowed_px2 = kShareBeyond * area_px2_;
  const float limit =
      areaBeyond_px2(tolerance_, kNoLimit) <= allowed_px2
          ? kNoLimit
          : largestThat([&](float each) { return areaBeyond_px2(tolerance_, each) > allowed_px2; });
  bool any = false;
  for (TileState& tile : tiles_) {
    if (tile.index == tile.last) continue;
    const float share =
        std::min(shareOf(limit, tile.typical), shareOf(kMostOverTolerance * tolerance_, tile.most));
    const std::size_t index = indexFor(tile, share);
    tile.is_next = index != tile.index;
    tile.index = index;
    any = any || tile.is_next;
  }
  return any;
}

float DiscsOfTiles::error() const {
  return largestThat(
      [&](float each) { return areaBeyond_px2(each, kNoLimit) <= kShareBeyond * area_px2_; });
}

}  // namespace foci
